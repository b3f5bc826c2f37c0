#pragma once
#include "row.h"

namespace palpate::stability {

/// One cell to run: pointers into rows and columns that outlive it.
struct Task {
  const Row* row = nullptr;
  const SubCase* sub_case = nullptr;
  const Column* column = nullptr;
};

/// Runs one cell until `expired` becomes true. Never throws: a rejection (Error) is an acceptable end, any
/// other exception is not.
/// @param limit_s CPU time [s] after which `expired` becomes true, for the message
StabilityCell run_cell(const Task& task, int seeds, double limit_s, const std::atomic<bool>& expired);

/// Runs all cells, each in a separate process, `jobs` at a time, and returns them in the order of the tasks.
/// A process that crashes or exceeds its limit leaves a cell with this verdict. Cells that did not end are
/// omitted.
std::vector<StabilityCell> run_cells(const std::vector<Task>& tasks, const StabilityOptions& options,
                                     experiments::EngineOutcome& outcome);

}  // namespace palpate::stability
