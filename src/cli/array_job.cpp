#include "cli/array_job.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <sstream>

#include "cli/missing_outputs.h"
#include "cli/paths.h"
#include "cli/progress.h"
#include "cli/stop.h"
#include "core/program.h"
#include "experiments/indices.h"
#include "experiments/unfinished_tasks.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;
using experiments::JobState;

constexpr double kFirstWaitSeconds = 0.5, kLongestWaitSeconds = 10.0;

/// Last submitted job of this folder, and the key of its list of tasks.
struct Submitted {
  std::string job, plan;
};

std::string job_file(const std::string& folder) { return (fs::path(folder) / "slurm" / "job").string(); }

Submitted last_submitted(const std::string& folder) {
  Submitted out;
  if (!fs::is_regular_file(job_file(folder))) return out;
  std::istringstream in(store::read_file(job_file(folder)));
  in >> out.job >> out.plan;
  return out;
}

/// Waits until the job has ended, or the user stops.  Where squeue does not answer, the results tell.
void wait_for(const std::string& job, experiments::UnfinishedTasks unfinished, std::size_t tasks) {
  Progress progress("job " + job);
  double pause_s = kFirstWaitSeconds;
  bool said = false;
  while (!stop_flag()) {
    const JobState state = experiments::job_state(job);
    if (state == JobState::kOver) return;
    if (state == JobState::kUnknown && unfinished.all_ended()) return;
    const std::size_t left = unfinished.count();
    progress(1.0 - static_cast<double>(left) / static_cast<double>(tasks),
             fmt::format("job {}, {} of {} tasks left", job, left, tasks));
    if (state == JobState::kUnknown && !said) {
      progress.wipe();
      fmt::print(stderr, "palpate: squeue does not answer; waiting for its controller\n");
      said = true;
    }
    for (double waited = 0.0; waited < pause_s && !stop_flag(); waited += 0.1) usleep(100000);
    pause_s = std::min(1.3 * pause_s, kLongestWaitSeconds);
  }
}

}  // namespace

CLI::Option* add_array_options(CLI::App& command, ArrayArguments& arguments) {
  CLI::Option* task =
      command
          .add_option("--task", arguments.tasks,
                      "run only these tasks, without a table, as an element of an array job does: 0-3,7")
          ->type_name("LIST");
  command
      .add_option("--plan", arguments.plan,
                  "fail unless the list of tasks has this key; array jobs pass it, so that a list that was "
                  "changed after submission is not run")
      ->type_name("KEY");
  CLI::Option* slurm = command
                           .add_flag("--slurm", arguments.slurm,
                                     "run as a Slurm array job, whose nodes share the folders; waits for it, "
                                     "then prints the same table")
                           ->excludes(task);
  command
      .add_option("--slurm-options", arguments.slurm_options,
                  "options of sbatch for every element: \"--partition=short --time=10\"")
      ->type_name("TEXT")
      ->needs(slurm);
  command
      .add_option(
          "--chunk", arguments.chunk,
          "minimum number of tasks per element, run one after another; more if the site's MaxArraySize "
          "requires it")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str()
      ->needs(slurm);
  command.add_flag("--no-wait", arguments.no_wait, "submit and return at once")->needs(slurm);
  return task;
}

TaskFolder::TaskFolder(const ArrayArguments& arguments, Use use)
    : arguments_(arguments), use_(std::move(use)) {
  if (use_.folder.empty()) return;
  if (!arguments.tasks.empty()) {
    store_ = experiments::ResultStore::element(use_.folder, arguments.tasks);
    return;
  }
  lock_ = store::FolderLock(use_.folder);
  const bool reads = use_.reads || arguments.slurm;
  if (use_.fresh || !reads) store_ = experiments::ResultStore::here(use_.folder, use_.fresh);
  if (!reads) return;
  store_ = {};  // Releases the folder for the elements of a job.
  store_ = experiments::ResultStore::read(use_.folder);
}

experiments::Place TaskFolder::place() {
  experiments::Place out{&store_, {}, arguments_.tasks, arguments_.plan};
  if (arguments_.slurm)
    out.submit = [this](experiments::Experiment& experiment,
                        const std::vector<std::vector<std::size_t>>& groups) {
      return submit(experiment, groups);
    };
  return out;
}

// Returns the job to wait for: submitted now, or by an earlier call.
std::string TaskFolder::job_of(experiments::Experiment& experiment,
                               const std::vector<std::vector<std::size_t>>& groups) {
  use_.job.elements.clear();
  const Submitted last = last_submitted(folder());
  const std::string key = experiment.key();
  // Slurm may still list a job for some seconds after its last result.
  if (!last.job.empty() && last.job != waited_for_ &&
      experiments::job_state(last.job) == JobState::kWaiting) {
    if (last.plan != key)
      fail(
          "job {} of this folder is still queued or running, for another version of the {}: wait for it "
          "(squeue -j {}), or cancel it (scancel {})",
          last.job, use_.what, last.job, last.job);
    fmt::print("job {} of this {} is still queued or running\n", last.job, use_.what);
    return last.job;
  }
  experiments::ArrayJob& job = use_.job;
  job.program = program_path();
  job.folder = fs::absolute(folder()).lexically_normal().string();
  job.options = arguments_.slurm_options;
  job.key = key;
  job.threads = 1;
  std::size_t tasks = 0;
  for (const auto& group : groups)
    for (const std::size_t i : group) {
      job.threads = std::max(job.threads, experiment.task(i).threads);
      ++tasks;
    }
  job.elements = experiments::elements_of(groups, static_cast<std::size_t>(arguments_.chunk),
                                          experiments::max_array_size());
  store::FolderLock::make((fs::path(folder()) / "slurm").string());
  const std::string script = (fs::path(folder()) / (job.command + ".sbatch")).string();
  store::write_atomically(script, experiments::sbatch_script(job));
  std::string number = experiments::submit(script);
  store::write_atomically(job_file(folder()), number + " " + key + "\n");
  fmt::print("submitted as job {}: {} tasks in an array of {}\n", number, tasks, job.elements.size());
  return number;
}

bool TaskFolder::submit(experiments::Experiment& experiment,
                        const std::vector<std::vector<std::size_t>>& groups) {
  const std::string job = job_of(experiment, groups);
  fmt::print("  squeue -j {0}        shows it\n  scancel {0}          ends it\n{1}", job, use_.hint);
  left_ = arguments_.no_wait;
  if (left_) return false;
  std::fflush(stdout);
  std::vector<experiments::Task> tasks;
  for (const auto& group : groups)
    for (const std::size_t i : group) tasks.push_back(experiment.task(i));
  wait_for(job, {folder(), tasks, use_.job.elements}, tasks.size());
  waited_for_ = job;
  if (stop_flag()) {
    fmt::print(stderr, "palpate: job {} continues without this command\n", job);
    return false;
  }
  lost_ = fmt::format("job {} ended without them: see {}/slurm/{}_*.log; the same command runs them again",
                      job, folder(), job);
  store_ = experiments::ResultStore::read(folder(), true);
  return true;
}

int TaskFolder::end(const experiments::EngineOutcome& outcome, long refused) {
  if (left_) return 0;
  if (outcome.other_plan)
    fail("{}: the {} or palpate has changed since the job was submitted; submit it again", use_.job.subject,
         use_.what);
  store_.close();
  fmt::print("{} run, {} done before{}; results in {}/tasks\n", outcome.run, outcome.reused,
             refused < 0 ? "" : fmt::format(", {} refused by their scenes", refused), folder());
  if (outcome.stopped) return kExitStopped;
  MissingOutputs missing;
  for (const experiments::LostTask& one : outcome.lost)
    missing.add(fmt::format("result of task {}", one.index), one.why);
  return missing.close(0);
}

void TaskFolder::add_missing(const experiments::EngineOutcome& outcome, MissingOutputs& missing) const {
  if (outcome.stopped) return;
  std::vector<std::size_t> tasks;
  for (const experiments::LostTask& one : outcome.lost)
    if (one.why.empty())
      tasks.push_back(one.index);
    else
      missing.add(fmt::format("result of task {}", one.index), one.why + "; the same command runs it again");
  if (!tasks.empty())
    missing.add(fmt::format("result of task{} {}", tasks.size() == 1 ? "" : "s", experiments::text_of(tasks)),
                lost_);
}

void TaskFolder::print_reused(std::size_t reused) {
  if (reused > 0) fmt::print("{} results are from earlier runs (--fresh repeats them)\n\n", reused);
}

void check_plan(const ArrayArguments& arguments, const std::string& key, const std::string& subject,
                const std::string& what) {
  if (!arguments.plan.empty() && arguments.plan != key)
    fail("{}: the {}, one of its scenes or palpate has changed since the job was submitted; submit it again",
         subject, what);
}

}  // namespace palpate::cli
