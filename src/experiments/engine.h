#pragma once
#include <atomic>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/result_store.h"
#include "experiments/task.h"

namespace palpate::experiments {

/// List of tasks, and what is done with their results.  Tasks are numbered from 0, in order of preference,
/// and the same on every machine.
class Experiment {
 public:
  virtual ~Experiment() = default;
  virtual std::size_t size() const = 0;  ///< Number of tasks.
  /// Returns a task that is wanted.
  virtual Task task(std::size_t i) = 0;
  /// Returns the bytes that the task's process gets.  Called when it starts.
  virtual std::string input(std::size_t i) = 0;
  /// Takes a result, new or stored.  Called once per task.
  virtual void take(std::size_t i, const Result& result) = 0;
  /// Returns whether the task is to be run at all, as far as that is known now.
  virtual bool is_wanted(std::size_t /*i*/) { return true; }
  /// Returns whether the results that the task needs are there.
  virtual bool is_ready(std::size_t /*i*/) { return true; }
  /// Returns whether a result is stored, or else computed again by the next call.
  virtual bool is_final(std::size_t /*i*/, const Result& /*result*/) { return true; }
  /// Returns whether tasks need results of other tasks: is_wanted() and is_ready() then change.
  virtual bool has_dependencies() const { return false; }
  /// Returns a number that is equal for tasks that one element of an array job runs, one after another.
  virtual std::size_t group(std::size_t i) { return i; }
  /// Returns the text for the progress after a result of task i.
  virtual std::string progress_text(std::size_t i) { return task(i).name; }
  /// Returns a hash of the whole list.
  virtual std::string key() = 0;
};

/// Runs tasks elsewhere: submits an array job with one element per list of tasks, and waits for it.
/// @return false where it was stopped, or did not wait
using Submit = std::function<bool(Experiment&, const std::vector<std::vector<std::size_t>>&)>;

/// Options of run().
struct EngineOptions {
  int jobs = 1;  ///< Number of parallel tasks.
  /// Runs only these tasks, in ascending order; results of other tasks are used where they are stored.
  const std::vector<std::size_t>* only = nullptr;
  Submit submit = {};                       ///< Empty: tasks run here.
  const std::atomic<bool>* stop = nullptr;  ///< Set from outside: active tasks are ended.
  /// Called after each new result, with the share of the requested tasks that are done or not wanted.
  std::function<void(double fraction, const std::string& what)> progress = {};
};

/// Task without a result: its process was killed from outside, or ran out of memory, or a result that it
/// needs is not stored and was not requested.
struct LostTask {
  std::size_t index = 0;
  std::string why;  ///< Empty where an array job ended without it.
};

/// Outcome of run().
struct EngineOutcome {
  /// Numbers of results of the requested tasks that were stored before, and new ones.
  std::size_t reused = 0, run = 0;
  std::vector<LostTask> lost;
  bool stopped = false;
  bool complete = false;    ///< Every wanted task has its result.
  bool other_plan = false;  ///< No task was run: the experiment is not the one of Place::plan.
};

/// Runs the tasks of an experiment that have no stored result, each in a separate process, and stores each
/// result when it is there.  A task that ran out of time is run again where it now has more time.  The
/// processes come from core's ProcessPool: a program that has started threads or drawn a picture must have
/// called ProcessPool::prepare() before.
/// @throws Error where a result cannot be stored
EngineOutcome run(Experiment& experiment, ResultStore& store, const EngineOptions& options);

/// Where the results of a command are, and which of its tasks it runs.
struct Place {
  ResultStore* store = nullptr;  ///< Null: results are kept in memory.
  Submit submit = {};            ///< See EngineOptions.
  /// Runs only these tasks, "0-3,7", of the experiment with the key `plan`; empty: all.
  std::string tasks = {}, plan = {};
};
/// Runs an experiment as `place` specifies.  @param options  submit and only: not used
EngineOutcome run(Experiment& experiment, const Place& place, EngineOptions options);

/// Returns the key of a result that depends on these words and on this build of palpate alone.
std::string key_of(std::initializer_list<std::string_view> words);

/// Returns `jobs`, or the number of cores where it is not positive.
int jobs_or_cores(int jobs);

}  // namespace palpate::experiments
