#pragma once
#include <string>
#include <vector>

#include "experiments/result_store.h"
#include "experiments/study/plan.h"

/// Table of the results of all tasks.
namespace palpate::study {

/// Row of the table.  Figures that a task does not have are empty.
struct Row {
  std::string status;  ///< "ok", "failed", "refused", "out of time", "crashed", "missing"
  std::string reason;
  std::vector<std::string> settings, figures, times;
};

/// Table of the whole study, one row per task, in the order of the tasks.
struct Results {
  std::vector<std::string> settings, figures, times;  ///< Names of the columns, with their units.
  std::vector<Row> rows;
  std::vector<std::size_t> missing;  ///< Tasks without a result.

  /// Returns the number of rows with that status.
  std::size_t count(const std::string& status) const;
};

/// Collects the existing results.  @pre every task is settled
Results merge(const Plan& plan, const experiments::ResultStore& store);

/// Writes study.csv (settings, status and figures: the same bytes on whichever machines, in any order, and in
/// however many runs the tasks were run), study-times.csv (times and machines) and study.toml (the study
/// itself).
void write(const Plan& plan, const Results& results, const std::string& folder);

}  // namespace palpate::study
