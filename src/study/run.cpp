#include "study/run.h"

#include <signal.h>

#include <filesystem>
#include <new>
#include <thread>

#include "core/bytes.h"
#include "core/process_pool.h"
#include "figures.h"
#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "store/atomic_file.h"
#include "task_file.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using Outcome = ProcessPool::Outcome;

/// Answer of a task's process that ran out of memory.
constexpr const char* kNoMemory = "no memory";

/// Encodes one task for a process that has no access to the study.
std::string encode_job(const Plan& plan, const Task& task) {
  const StudyScene& scene = plan.scenes[task.scene];
  ByteWriter out;
  out.put(scene.text).put(scene.path).put(plan.spec.repeats).put(task.overrides.size());
  for (const std::string& one : task.overrides) out.put(one);
  return out.take();
}

/// Runs a task encoded by encode_job(); a ProcessPool::Work.
std::string run_job(const std::string& order, const std::atomic<bool>& out_of_time) {
  ByteReader in(order);
  const auto text = in.get<std::string>(), path = in.get<std::string>();
  const int repeats = in.get<int>();
  std::vector<std::string> overrides(in.get<std::size_t>());
  for (std::string& one : overrides) one = in.get<std::string>();
  try {
    const Json result = run_scene(loop::parse(text, path, overrides), repeats, out_of_time);
    return result.dump(-1, ' ', false, Json::error_handler_t::replace);
  } catch (const std::bad_alloc&) { return kNoMemory; }
}

Json without_figures(const char* status, const std::string& reason) {
  return {{"status", status}, {"reason", reason}, {"figures", Json::object()}, {"times", Json::object()}};
}

/// Whether the process was ended from outside: by a node that goes down, an administrator, or the kernel when
/// it runs out of memory.  Other signals are crashes of the task.
bool is_from_outside(int signal) { return signal == SIGKILL || signal == SIGTERM || signal == SIGHUP; }

class Runner {
 public:
  Runner(Plan& plan, const RunOptions& options, int jobs) : plan_(plan), options_(options), pool_(jobs) {}

  RunOutcome run(const std::vector<std::size_t>& open, RunOutcome outcome) {
    out_ = std::move(outcome);
    most_ = open.size();
    for (std::size_t next = 0; !stopped();) {
      while (next < open.size() && pool_.has_room() && !stopped()) start(plan_.tasks[open[next++]]);
      if (pool_.idle()) break;
      pool_.wait(0.2);
    }
    out_.stopped = stopped();
    return std::move(out_);
  }

 private:
  bool stopped() const { return options_.stop && options_.stop->load(); }

  void start(const Task& task) {
    pool_.start(run_job, encode_job(plan_, task), plan_.spec.limit_s,
                [this, &task](const Outcome& outcome) { done(task, outcome); });
  }

  void done(const Task& task, const Outcome& outcome) {
    if (stopped()) return;  // The task may have been interrupted.
    ++ended_;
    if (options_.progress)
      options_.progress(static_cast<double>(ended_) / static_cast<double>(most_),
                        fmt::format("task {}", task.index));
    const bool killed = outcome.end == Outcome::End::kCrash && is_from_outside(outcome.signal);
    if (killed || (outcome.end == Outcome::End::kDone && outcome.bytes == kNoMemory)) {
      out_.lost.push_back({task.index, killed ? outcome.bytes : "not enough memory"});
      return;
    }
    const Json file = task_file(plan_, task, result_of(outcome));
    store::write_atomically(result_path(options_.folder, task),
                            file.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
    ++out_.run;
  }

  Json result_of(const Outcome& outcome) const {
    const std::string out_of_time = out_of_time_reason(plan_);
    switch (outcome.end) {
      case Outcome::End::kDone: {
        Json result = Json::parse(outcome.bytes);
        if (result["status"] == "out of time") result["reason"] = out_of_time;
        return result;
      }
      case Outcome::End::kOutOfTime: return without_figures("out of time", out_of_time);
      case Outcome::End::kError: return without_figures("crashed", "internal error: " + outcome.bytes);
      case Outcome::End::kCrash: break;
    }
    return without_figures("crashed", outcome.bytes);
  }

  Plan& plan_;
  const RunOptions& options_;
  ProcessPool pool_;
  RunOutcome out_;
  std::size_t ended_ = 0, most_ = 0;
};

/// Returns the number of parallel tasks: cores over the largest number of threads of a task.
int jobs_for(const Plan& plan, const std::vector<std::size_t>& open, const RunOptions& options) {
  if (options.jobs > 0) return options.jobs;
  int threads = 1;
  for (const std::size_t i : open) threads = std::max(threads, plan.tasks[i].threads);
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / threads);
}

}  // namespace

bool is_done(const Plan& plan, const std::string& folder, const Task& task) {
  PALPATE_CHECK(task.settled, "task {} is not settled", task.index);
  if (!task.refused.empty()) return true;
  const auto file = read_task_file(folder, task);
  return file && is_final(plan, *file);
}

RunOutcome run_tasks(Plan& plan, const std::vector<std::size_t>& indices, const PlanHelp& help,
                     const RunOptions& options) {
  std::error_code error;
  fs::create_directories(fs::path(options.folder) / "tasks", error);
  if (error) fail("{}/tasks: cannot be created: {}", options.folder, error.message());
  RunOutcome outcome;
  std::vector<std::size_t> open;
  for (const std::size_t i : indices) {
    Task& task = plan.tasks[i];
    settle(plan, task, help);
    if (!task.refused.empty())
      ++outcome.refused;
    else if (is_done(plan, options.folder, task))
      ++outcome.reused;
    else
      open.push_back(i);
  }
  return Runner(plan, options, jobs_for(plan, open, options)).run(open, std::move(outcome));
}

void forget_results(const std::string& folder) {
  // The folder itself is kept: it carries the lock.
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(fs::path(folder) / "tasks", error)) {
    std::error_code failed;
    fs::remove_all(entry.path(), failed);
    if (failed) fail("{}: cannot be removed: {}", entry.path().string(), failed.message());
  }
}

}  // namespace palpate::study
