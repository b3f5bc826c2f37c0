#pragma once
#include "options.h"

namespace palpate::cli {

/// The file, or the shape of that name with its own numbers of elements where none were asked for.
/// @throws Error for neither, with the nearest name
model::Input input_of(ModelArguments& arguments);

/// "head, human, gear, pumpkin"; empty where this build has no shapes.
std::string shape_names();

}  // namespace palpate::cli
