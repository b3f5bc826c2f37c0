#pragma once
#include "experiments/engine.h"
#include "palpate/experiments/comparison.h"

namespace palpate::compare {

/// Runs a comparison as run() of compare.h does, where `place` specifies.
/// @param options  folder: not used
/// @param outcome  what was run
/// @return no scenes where an array job has not finished the trials of LinearSolvers::kBest
Comparison run(const std::vector<scene::Description>& scenes, const CompareOptions& options,
               const experiments::Place& place, experiments::EngineOutcome& outcome);

}  // namespace palpate::compare
