#pragma once
#include <string>
#include <vector>

#include "compare/haptic.h"
#include "store/summary.h"

namespace palpate::cli {

/// Repeats a run with tool and bodies as one system, and prints against_monolithic_remarks().
/// @param real_time  whether the run was
compare::AgainstMonolithic against_monolithic(const loop::World& world,
                                              const std::vector<loop::HapticRecord>& records, bool real_time);

/// The error of the wrench on each hand against the monolithic solution, a line each; none where there is no
/// such solution.
std::vector<std::string> against_monolithic_remarks(const scene::Description& description,
                                                    const compare::AgainstMonolithic& against);

/// Its figures into the run's summary.
void add_against_monolithic(store::Summary& summary, const scene::Description& description,
                            const compare::AgainstMonolithic& against);

}  // namespace palpate::cli
