#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "cli/paths.h"
#include "cli/progress.h"
#include "cli/stop.h"
#include "core/program.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/result_folder.h"
#include "study.h"
#include "study/slurm.h"

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;
using study::JobState;
using study::Plan;

constexpr double kFirstWaitSeconds = 0.5, kLongestWaitSeconds = 10.0;

/// Last submitted job of the study in this folder, and the key of its plan.
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

std::vector<std::size_t> open_tasks(const Plan& plan, const std::string& folder) {
  std::vector<std::size_t> out;
  for (const study::Task& task : plan.tasks)
    if (!study::is_done(plan, folder, task)) out.push_back(task.index);
  return out;
}

/// Returns the job to wait for: submitted now, or by an earlier call.
std::string job_of(const Plan& plan, const std::vector<std::size_t>& open, const StudyArguments& arguments,
                   const std::string& folder) {
  const Submitted last = last_submitted(folder);
  if (!last.job.empty() && study::job_state(last.job) == JobState::kWaiting) {
    if (last.plan != plan.key)
      fail(
          "job {} of this folder is still queued or running, for another version of the study: wait for it "
          "(squeue -j {}), or cancel it (scancel {})",
          last.job, last.job, last.job);
    fmt::print("job {} of this study is still queued or running\n", last.job);
    return last.job;
  }
  study::ArrayJob array;
  array.program = program_path();
  array.folder = fs::absolute(folder).lexically_normal().string();
  array.options = arguments.slurm_options;
  for (const std::size_t i : open) array.threads = std::max(array.threads, plan.tasks[i].threads);
  array.elements =
      study::elements_of(open, static_cast<std::size_t>(arguments.chunk), study::max_array_size());
  store::ResultFolder::make((fs::path(folder) / "slurm").string());
  store::ResultFolder::make((fs::path(folder) / "tasks").string());
  const std::string script = (fs::path(folder) / "study.sbatch").string();
  store::write_atomically(script, study::sbatch_script(plan, array));
  const std::string job = study::submit(script);
  store::write_atomically(job_file(folder), job + " " + plan.key + "\n");
  fmt::print("submitted as job {}: {} tasks in an array of {}\n", job, open.size(), array.elements.size());
  return job;
}

/// Removes tasks that have a result from `open`. Reading the list of the folder first makes a network file
/// system refresh its cache of missing files.
void drop_done(const Plan& plan, const std::string& folder, std::vector<std::size_t>& open) {
  std::error_code none;
  for (fs::directory_iterator at(fs::path(folder) / "tasks", none), end; at != end; at.increment(none)) {}
  std::erase_if(open, [&](std::size_t i) { return study::is_done(plan, folder, plan.tasks[i]); });
}

/// Waits until every task has its result, or the job has ended.
void wait_for(const Plan& plan, const std::string& job, const std::string& folder,
              std::vector<std::size_t> open) {
  const auto most = static_cast<double>(open.size());
  Progress progress("job " + job);
  double pause_s = kFirstWaitSeconds;
  bool said = false;
  while (!stop_flag()) {
    const JobState state = study::job_state(job);  // before the files: a finished job has written them
    drop_done(plan, folder, open);
    if (open.empty() || state == JobState::kOver) return;
    if (state == JobState::kUnknown && !said) {
      progress.wipe();
      fmt::print(stderr, "palpate: squeue does not answer; waiting for its controller\n");
      said = true;
    }
    progress(1.0 - static_cast<double>(open.size()) / most,
             fmt::format("job {}: {} tasks left", job, open.size()));
    for (double waited = 0.0; waited < pause_s && !stop_flag(); waited += 0.1) usleep(100000);
    pause_s = std::min(1.3 * pause_s, kLongestWaitSeconds);
  }
}

}  // namespace

StudyEnd study_by_slurm(Plan& plan, const StudyArguments& arguments, const std::string& folder) {
  const std::vector<std::size_t> open = open_tasks(plan, folder);
  if (open.empty()) return {};
  const std::string job = job_of(plan, open, arguments, folder);
  fmt::print("  squeue -j {0}        shows it\n  scancel {0}          ends it\n", job);
  fmt::print("  palpate study {} -o {} --merge        makes the table of the results so far\n",
             arguments.study, folder);
  if (arguments.no_wait) return {false, true, ""};
  std::fflush(stdout);
  wait_for(plan, job, folder, open);
  if (stop_flag()) fmt::print(stderr, "palpate: job {} continues without this command\n", job);
  return {stop_flag().load(), false,
          fmt::format("job {} ended without them: see {}/slurm/{}_*.log; the same command runs them again",
                      job, folder, job)};
}

}  // namespace palpate::cli
