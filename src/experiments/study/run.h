#pragma once
#include <cstddef>
#include <vector>

#include "experiments/engine.h"
#include "experiments/study/plan.h"

namespace palpate::study {

/// Result of run_tasks().
struct RunOutcome : experiments::EngineOutcome {
  std::size_t refused = 0;  ///< Number of tasks that their scenes reject.
};

/// Runs the tasks that have no result yet, each in a separate process.
/// @param indices  tasks to run, in ascending order; they get settled
/// @param options  jobs: 0 for the number of cores over the threads per task; only: not used
/// @throws Error where a result cannot be stored
RunOutcome run_tasks(Plan& plan, const std::vector<std::size_t>& indices, const PlanHelp& help,
                     experiments::ResultStore& store, experiments::EngineOptions options);

}  // namespace palpate::study
