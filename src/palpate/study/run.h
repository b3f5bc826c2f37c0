#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "palpate/study/plan.h"

/// Runs tasks, each in a process of its own, and keeps each result in a file of its own,
/// FOLDER/tasks/KEY.json: written whole or not at all, by whichever machine ran the task.
namespace palpate::study {

struct RunOptions {
  std::string folder;
  int jobs = 0;  ///< tasks side by side; 0: as many as there are cores for the threads of the tasks
  const std::atomic<bool>* stop = nullptr;
  std::function<void(double fraction, const std::string& what)> progress = {};
};

/// A task that ended without a result: its process was killed from outside, or found no memory.  Nothing is
/// kept of it, so that the next call runs it again.
struct LostTask {
  std::size_t index = 0;
  std::string why;
};

struct RunOutcome {
  std::size_t reused = 0, run = 0, refused = 0;
  std::vector<LostTask> lost;
  bool stopped = false;
};

/// Runs what has no result yet.  A result that ran out of time is run again where the study now allows more.
/// @param indices  which tasks; they get settled
/// @throws Error where a result cannot be written
RunOutcome run_tasks(Plan& plan, const std::vector<std::size_t>& indices, const PlanHelp& help,
                     const RunOptions& options);

/// Path of a task's result.  @pre settled, not refused
std::string result_path(const std::string& folder, const Task& task);

/// Whether a task needs no run: it has a usable result, or its scene refuses it.  @pre settled
bool is_done(const Plan& plan, const std::string& folder, const Task& task);

/// Removes the results of all studies in the folder.
void forget_results(const std::string& folder);

}  // namespace palpate::study
