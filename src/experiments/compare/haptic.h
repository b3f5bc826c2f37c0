#pragma once
#include "experiments/compare/haptic_comparison.h"
#include "experiments/engine.h"

namespace palpate::compare {

/// Varies exchange period, tick, contact resolution, integrator and linearisation about the scene, one at a
/// time, and measures the error of the wrench on the hand against the monolithic solution
/// (`[compare.haptic]`). Each run has a separate process: references run in parallel, the timed points one at
/// a time unless `options.jobs` specifies otherwise.
/// @param options  integrators: replaces the scene's list; all and folder: not used
/// @param place  where the runs are made and kept
/// @param outcome  what was run
/// @throws Error for a scene without a tool or without bodies
HapticComparison compare_haptic(const scene::Description& description, const CompareOptions& options,
                                const experiments::Place& place, experiments::EngineOutcome& outcome);

/// Writes haptic.csv into `folder`: report takes its table and charts from it and from summary.json.
void write(const HapticComparison& comparison, const std::string& folder);

}  // namespace palpate::compare
