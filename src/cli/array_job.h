#pragma once
#include <string>
#include <vector>

#include "experiments/engine.h"
#include "experiments/slurm.h"
#include "store/folder_lock.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace palpate::cli {

class MissingOutputs;

/// Arguments of commands that run their tasks as an array job of Slurm, or only some of them.
struct ArrayArguments {
  std::string tasks;          ///< Tasks to run, without a table: "0-3,7"; empty: all
  std::string plan;           ///< Required key of the list of tasks; empty: any
  bool slurm = false;         ///< Runs the tasks as an array job
  std::string slurm_options;  ///< Options of sbatch
  int chunk = 1;              ///< Least number of groups of tasks per element of the array
  bool no_wait = false;       ///< Submits the job and returns
};

/// Adds --task, --plan, --slurm, --slurm-options, --chunk and --no-wait.  @return --task
CLI::Option* add_array_options(CLI::App& command, ArrayArguments& arguments);

/// Folder of a command that runs tasks: its lock, the stored results, and the array job.
class TaskFolder {
 public:
  /// How the folder is used.
  struct Use {
    std::string folder;         ///< Empty: results are kept in memory.
    bool fresh = false;         ///< Discards earlier results.
    bool reads = false;         ///< Runs nothing here.
    std::string what;           ///< "study": what is submitted, in messages.
    experiments::ArrayJob job;  ///< Command, words, name and subject; the other members are set here.
    std::string hint = {};      ///< Printed after the commands of Slurm.
  };
  /// Locks the folder, unless only the tasks of --task are run, and opens its results.
  /// @throws Error where the folder is in use
  TaskFolder(const ArrayArguments& arguments, Use use);
  TaskFolder(const TaskFolder&) = delete;
  TaskFolder& operator=(const TaskFolder&) = delete;

  const std::string& folder() const { return use_.folder; }
  experiments::ResultStore& store() { return store_; }
  experiments::Place place();
  /// Returns whether the command ends without tables: with --task, or after --no-wait.
  bool ends_early() const { return left_ || !arguments_.tasks.empty(); }
  /// Ends a command without tables.  @param refused  number of tasks that their scenes reject; negative: none
  /// can be  @return the exit status  @throws Error where the list of tasks is not the one of --plan
  int end(const experiments::EngineOutcome& outcome, long refused = -1);
  /// Returns why results are missing; empty: no job has ended.
  const std::string& lost() const { return lost_; }
  /// Adds the tasks that ended without a result, here or in a job; none where the user stopped the command.
  void add_missing(const experiments::EngineOutcome& outcome, MissingOutputs& missing) const;
  /// Prints how many results are not new.
  static void print_reused(std::size_t reused);

 private:
  std::string job_of(experiments::Experiment& experiment,
                     const std::vector<std::vector<std::size_t>>& groups);
  bool submit(experiments::Experiment& experiment, const std::vector<std::vector<std::size_t>>& groups);
  const ArrayArguments& arguments_;
  Use use_;
  store::FolderLock lock_;
  experiments::ResultStore store_;
  std::string lost_, waited_for_;  ///< Why results are missing; the last job that has ended.
  bool left_ = false;              ///< Submitted without waiting.
};

/// Checks the key of the list of tasks that an element was submitted for.
/// @throws Error where the list has changed
void check_plan(const ArrayArguments& arguments, const std::string& key, const std::string& subject,
                const std::string& what);

}  // namespace palpate::cli
