#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "study/plan.h"

/// Runs tasks, each in a separate process, and stores each result in a separate file, FOLDER/tasks/KEY.json,
/// which the machine that ran the task writes atomically.
namespace palpate::study {

/// Options of run_tasks().
struct RunOptions {
  std::string folder;
  int jobs = 0;  ///< Tasks run in parallel; 0: number of cores over threads per task.
  const std::atomic<bool>* stop = nullptr;
  std::function<void(double fraction, const std::string& what)> progress = {};
};

/// Task that ended without a result: its process was killed from outside, or ran out of memory.  Nothing is
/// stored, so the next call runs it again.
struct LostTask {
  std::size_t index = 0;
  std::string why;
};

/// Result of run_tasks(): numbers of tasks.
struct RunOutcome {
  std::size_t reused = 0, run = 0, refused = 0;
  std::vector<LostTask> lost;
  bool stopped = false;
};

/// Runs the tasks that have no result yet.  A task that ran out of time is run again where the study now
/// allows more.
/// @param indices  tasks to run; they get settled
/// @throws Error where a result cannot be written
RunOutcome run_tasks(Plan& plan, const std::vector<std::size_t>& indices, const PlanHelp& help,
                     const RunOptions& options);

/// Returns the path of a task's result.  @pre settled, not rejected
std::string result_path(const std::string& folder, const Task& task);

/// Whether a task needs no run: it has a usable result, or its scene rejects it.  @pre settled
bool is_done(const Plan& plan, const std::string& folder, const Task& task);

/// Removes the results of all studies in the folder.
void forget_results(const std::string& folder);

}  // namespace palpate::study
