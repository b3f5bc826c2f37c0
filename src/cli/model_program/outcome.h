#pragma once
#include "model/make_model.h"

namespace palpate::cli {

/// Prints the repairs of the surface, counts and quality figures, and the time of each step.
void print_outcome(const model::Made& made, const std::string& path);

}  // namespace palpate::cli
