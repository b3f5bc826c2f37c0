#pragma once
#include <string>
#include <vector>

#include "experiments/compare/monolithic.h"

namespace palpate::session {

/// Returns the error of the wrench on each hand against the monolithic solution, one line per quantity; empty
/// if there is no monolithic solution.
std::vector<std::string> monolithic_remarks(const scene::Description& description,
                                            const compare::AgainstMonolithic& against);

}  // namespace palpate::session
