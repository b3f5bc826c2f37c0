#pragma once
#include <string>
#include <vector>

#include "palpate/study/plan.h"

/// Merges the files of all tasks into one table.
namespace palpate::study {

/// One row of the table.  Figures that a task has not are empty.
struct Row {
  std::string status;  ///< "ok", "failed", "refused", "out of time", "crashed", "missing"
  std::string reason;
  std::vector<std::string> settings, figures, times;
};

/// The whole study, a row a task in the order of the tasks.
struct Results {
  std::vector<std::string> settings, figures, times;  ///< names of the columns, with their units
  std::vector<Row> rows;
  std::vector<std::size_t> missing;  ///< tasks without a result

  std::size_t count(const std::string& status) const;
};

/// Reads what is there.  @pre every task is settled
Results merge(const Plan& plan, const std::string& folder);

/// Writes study.csv (settings, status and figures: the same bytes whichever machines ran it, in any order, at
/// one go or not), study-times.csv (times and machines) and study.toml (the study itself).
void write(const Plan& plan, const Results& results, const std::string& folder);

}  // namespace palpate::study
