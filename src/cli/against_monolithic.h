#pragma once
#include "palpate/compare/haptic.h"
#include "palpate/store/summary.h"

namespace palpate::cli {

/// Repeats a run with tool and bodies as one system, and prints how far the wrench on the hand was from it.
/// @param real_time  whether the run was
compare::AgainstMonolithic against_monolithic(const loop::World& world,
                                              const std::vector<loop::HapticRecord>& records, bool real_time);

/// Its figures into the run's summary.
void add_against_monolithic(store::Summary& summary, const scene::Description& description,
                            const compare::AgainstMonolithic& against);

}  // namespace palpate::cli
