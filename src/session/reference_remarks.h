#pragma once
#include <string>
#include <vector>

#include "experiments/compare/monolithic.h"

namespace palpate::session {

/// Returns the error of the wrench on each hand against a reference, one line per quantity; empty if the
/// reference failed or was stopped.
std::vector<std::string> reference_remarks(const scene::Description& description,
                                           const compare::AgainstReference& against);

}  // namespace palpate::session
