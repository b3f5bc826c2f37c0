#pragma once
#include "row.h"

namespace palpate::stability {

/// One cell to run: pointers into rows and columns that outlive it.
struct Task {
  const Row* row = nullptr;
  const SubCase* sub_case = nullptr;
  const Column* column = nullptr;
};

/// Runs one cell until `expired` becomes true.  Never throws: a refusal (Error) is a clear end, anything else
/// that is thrown is not.
/// @param limit_s  what it expires after, for the message
StabilityCell run_cell(const Task& task, int seeds, double limit_s, const std::atomic<bool>& expired);

/// Runs all cells, each in a process of its own, `jobs` at a time, and gives them in the order of the tasks.
/// A process that dies or does not heed its limit leaves a cell that says so.  Cells that were not begun when
/// `stop` became true are left out.
std::vector<StabilityCell> run_cells(const std::vector<Task>& tasks, const StabilityOptions& options);

}  // namespace palpate::stability
