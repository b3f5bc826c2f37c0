#include "experiments/study/run.h"

#include <algorithm>

#include "core/archive_bytes.h"
#include "core/clock.h"
#include "experiments/slurm.h"
#include "experiments/study/figures.h"
#include "palpate/core/error.h"
#include "palpate/loop/load.h"

namespace palpate::study {
namespace {

/// Input of a task's process, which has no access to the study.
struct Job {
  std::string text, path;
  std::vector<std::string> overrides;
  int repeats = 1;

  void archive(Archive& a) {
    a("text", text);
    a("path", path);
    a("repeats", repeats);
    a.list("overrides", overrides, [&a](std::string& one) { a("", one); });
  }
};

/// Runs a task; a ProcessPool::Work.
std::string run_job(const std::string& input, const std::atomic<bool>& out_of_time) {
  const auto job = restored<Job>(input);
  const SceneRun run = run_scene(loop::parse(job.text, job.path, job.overrides), job.repeats, out_of_time);
  experiments::Result result;
  result.status = run.status;
  result.reason = run.reason;
  result.cpu_s = cpu_seconds();
  result.bytes = archived(run);
  return archived(result);
}

/// Returns the command line that runs this task alone and keeps the recorded files.
std::string command_of(const Plan& plan, const Task& task) {
  std::string out = "palpate run " + experiments::quoted(plan.scenes[task.scene].path);
  for (const std::string& change : task.overrides) out += " --set " + experiments::quoted(change);
  return out;
}

/// Tasks of a study, numbered as in its plan.
class Tasks : public experiments::Experiment {
 public:
  Tasks(Plan& plan, const PlanHelp& help) : plan_(plan), help_(help) {}

  std::size_t size() const override { return plan_.tasks.size(); }
  bool is_wanted(std::size_t i) override {
    settle(plan_, plan_.tasks[i], help_);
    return plan_.tasks[i].refused.empty();
  }
  experiments::Task task(std::size_t i) override {
    const Task& one = plan_.tasks[i];
    return {"study", one.key, command_of(plan_, one), run_job, plan_.spec.limit_s, false, one.threads};
  }
  std::string input(std::size_t i) override {
    const StudyScene& scene = plan_.scenes[plan_.tasks[i].scene];
    return archived(Job{scene.text, scene.path, plan_.tasks[i].overrides, plan_.spec.repeats});
  }
  void take(std::size_t, const experiments::Result&) override {}  // The table is made of the stored results.
  std::string progress_text(std::size_t i) override { return fmt::format("task {}", i); }
  std::string key() override { return plan_.key; }

 private:
  Plan& plan_;
  const PlanHelp& help_;
};

}  // namespace

RunOutcome run_tasks(Plan& plan, const std::vector<std::size_t>& indices, const PlanHelp& help,
                     experiments::ResultStore& store, experiments::EngineOptions options) {
  RunOutcome out;
  int threads = 1;
  for (const std::size_t i : indices) {
    settle(plan, plan.tasks[i], help);
    out.refused += !plan.tasks[i].refused.empty();
    threads = std::max(threads, plan.tasks[i].threads);
  }
  if (options.jobs <= 0) options.jobs = std::max(1, experiments::jobs_or_cores(0) / threads);
  options.only = &indices;
  Tasks tasks(plan, help);
  static_cast<experiments::EngineOutcome&>(out) = run(tasks, store, options);
  return out;
}

}  // namespace palpate::study
