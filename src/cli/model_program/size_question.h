#pragma once
#include "options.h"

namespace palpate::cli {

/// A body beyond 10 m, or below 1 mm, is mostly one in other units: without --scale this asks whether it is
/// meant, on a terminal; elsewhere it refuses, and says how to say so.
/// @throws Error where it is not meant, or no one can be asked
void ask_about_size(const ModelArguments& arguments, const model::Input& input);

}  // namespace palpate::cli
