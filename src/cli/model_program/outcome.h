#pragma once
#include "model/make_model.h"

namespace palpate::cli {

/// Prints what was mended, the counts and figures, and how long each step took.
void print_outcome(const model::Made& made, const std::string& path);

}  // namespace palpate::cli
