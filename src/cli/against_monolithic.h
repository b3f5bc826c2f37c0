#pragma once
#include <string>
#include <vector>

#include "experiments/compare/monolithic.h"

namespace palpate::cli {

/// Computes the monolithic solution of a run (tool and bodies integrated together), prints
/// against_monolithic_remarks() and returns the errors of the run against it.
/// @param real_time  whether the run was in real time
compare::AgainstMonolithic against_monolithic(const loop::World& world,
                                              const std::vector<loop::HapticRecord>& records, bool real_time);

/// Returns the error of the wrench on each hand against the monolithic solution, one line per quantity; empty
/// if there is no monolithic solution.
std::vector<std::string> against_monolithic_remarks(const scene::Description& description,
                                                    const compare::AgainstMonolithic& against);

}  // namespace palpate::cli
