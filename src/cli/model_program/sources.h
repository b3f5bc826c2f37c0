#pragma once
#include "model_arguments.h"

namespace palpate::cli {

/// Reads the file, or builds the shape of that name with its default numbers of elements if none were
/// requested.
/// @throws Error if it is neither, with the nearest name
model::Input input_of(ModelArguments& arguments);

/// Returns the names of the shapes: "head, human, gear, pumpkin"; empty if this build has no shapes.
std::string shape_names();

}  // namespace palpate::cli
