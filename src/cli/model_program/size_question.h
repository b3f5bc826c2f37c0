#pragma once
#include "model_arguments.h"

namespace palpate::cli {

/// Checks the size of a body. A body above 10 m or below 1 mm is usually in other units: without --scale, a
/// question on the terminal asks for confirmation; without a terminal the body is rejected with the option to
/// give.
/// @throws Error if the size is not confirmed, or there is no terminal
void ask_about_size(const ModelArguments& arguments, const model::Input& input);

}  // namespace palpate::cli
