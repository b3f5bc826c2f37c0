#pragma once
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "experiments/task.h"

namespace palpate::experiments {

/// Tasks of an array job that have no result yet in a complete file of an element (result_store.h).  Takes no
/// lock, so that elements can start meanwhile.
class UnfinishedTasks {
 public:
  /// @param lists  tasks of each element, as text; empty: unknown
  UnfinishedTasks(std::string folder, const std::vector<Task>& tasks, std::vector<std::string> lists);
  /// Reads the files that elements have completed since the last call.
  /// @return the number of tasks without a result; a task without a key always counts
  std::size_t count();
  /// Returns whether every task has its result, or every element has completed its file: elements do not run
  /// tasks that turn out not to be wanted.
  bool all_ended();

 private:
  void read(const std::string& path);
  std::string folder_;
  std::vector<std::string> lists_;
  std::map<std::string, double> limits_s_;  ///< Limit of each task without a result, by its key.
  std::set<std::string> read_;              ///< Files, with the times of their last change.
};

}  // namespace palpate::experiments
