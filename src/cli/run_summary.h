#pragma once
#include <optional>
#include <string>
#include <vector>

#include "experiments/compare/monolithic.h"
#include "loop/checkpoints.h"
#include "loop/run_figures.h"
#include "palpate/loop/run.h"
#include "run.h"

namespace palpate::cli {

/// Result of one run and its cost.
struct RunOutput {
  loop::RunResult result;
  std::vector<std::string> remarks;  ///< Lines of run_remarks()
  double assemble_s = 0.0;
  loop::RunFigures figures;
  loop::CheckpointCost checkpoints;
  std::optional<compare::AgainstMonolithic> against;  ///< Set with --against-monolithic
};

/// Outcome of a run that has no result.
struct Outcome {
  std::string word, message;
};

/// Prints the cost of a run, the largest force and torque on each hand, and the remarks.
void print_outcome(const loop::World& world, const RunOutput& ran);

/// Writes summary.json and scene.toml.
/// @param outcome  replaces the outcome that the result implies
void keep_summary(const loop::World& world, const RunOutput& ran, const RunArguments& arguments,
                  const std::string& folder, const std::optional<Outcome>& outcome = {});

}  // namespace palpate::cli
