#include "palpate/compare/compare.h"

#include <algorithm>
#include <map>
#include <thread>

#include "core/process_pool.h"
#include "ledger.h"
#include "palpate/core/error.h"
#include "work.h"

namespace palpate::compare {
namespace {

using Outcome = ProcessPool::Outcome;

PointStatus status_of(Outcome::End end) {
  switch (end) {
    case Outcome::End::kDone: return PointStatus::kOk;
    case Outcome::End::kError: return PointStatus::kRefused;
    case Outcome::End::kCrash: return PointStatus::kCrashed;
    case Outcome::End::kOutOfTime: return PointStatus::kOutOfTime;
  }
  return PointStatus::kCrashed;
}

/// Study in progress.  All results pass through the database's rows, whether new or resumed: a study that was
/// killed and restarted gives the same table.
class Study {
 public:
  Study(const std::vector<scene::Description>& scenes, const CompareOptions& options,
        const std::vector<SolverChoice>& choices, bool trials = false)
      : options_(options),
        jobs_(options.jobs > 0 ? options.jobs
                               : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
        pool_(jobs_),
        database_(options.database.empty() ? ":memory:" : options.database, run_columns()),
        ledger_(scenes, options, choices, trials) {}

  Comparison run() {
    while (!stopped()) {
      ledger_.settle_references();
      bool open = false, moved = false;
      for (Task& task : ledger_.tasks) {
        if (!task.done) moved |= proceed(task);
        open |= !task.done;
      }
      if (!open) break;
      if (moved) continue;  // Results may have made other tasks ready.
      PALPATE_CHECK(!pool_.idle(), "nothing runs, and nothing can be started");
      pool_.wait(0.2);
    }
    ledger_.out.stopped = stopped();
    ledger_.finish(jobs_);
    return std::move(ledger_.out);
  }

 private:
  bool stopped() const { return options_.stop && options_.stop->load(); }

  /// Advances one task as far as possible now; returns true where that may let others proceed.
  bool proceed(Task& task) {
    if (task.started) return false;
    if (ledger_.is_pointless(task)) return task.done = true;
    if (!ledger_.is_ready(task)) return false;
    if (!task.looked_up) {
      task.looked_up = true;
      resume(task);
      if (task.done) return true;
    }
    if (!has_room_for(task)) return false;
    start(task);
    return true;
  }

  /// Whether a task may start now: unless a number of jobs is requested, timed runs run alone.
  bool has_room_for(const Task& task) const {
    if (options_.jobs > 0 || task.is_reference()) return pool_.has_room() && !timed_runs_;
    return pool_.idle();
  }

  /// Takes the result of an earlier study, if it is still valid.
  void resume(Task& task) {
    if (!task.is_point()) {
      const auto kept = database_.artefact(ledger_.artefact_key(task));
      if (!kept || (kept->status == "out of time" && kept->cpu_s < ledger_.limit_of(task))) return;
      if (!Ledger::is_complete(task, *kept)) return;
      reuse(task, *kept);
      return;
    }
    for (const store::StudyRun& row : database_.runs(ledger_.key_of(task))) {
      const bool wants_more_time = row.status == "out of time" && compare::limit_of(row) < options_.limit_s;
      const bool other_reference =
          task.kind == Task::Kind::kPoint && point_run_of(row).reference != ledger_.reference_used(task);
      if (row.repeat == task.repeat && !wants_more_time && !other_reference) reuse(task, row);
    }
  }

  template <typename Kept>
  void reuse(Task& task, const Kept& kept) {
    task.started = task.done = true;
    ledger_.take(task, kept);
    ++ledger_.out.reused;
  }

  void start(Task& task) {
    task.started = true;
    timed_runs_ = options_.jobs <= 0 && !task.is_reference();
    Task* at = &task;
    pool_.start(run_job, order(task), ledger_.limit_of(task),
                [this, at](const Outcome& outcome) { done(*at, outcome); });
  }

  /// Encodes the input of the run's process.
  std::string order(const Task& task) {
    const SceneWork& scene = ledger_.work[task.scene];
    const double limit_s = ledger_.limit_of(task);
    switch (task.kind) {
      case Task::Kind::kPrimary:
        return encode_job(WorkKind::kReference, scene.planned.primary, limit_s, nullptr);
      case Task::Kind::kCheck: return encode_job(WorkKind::kReference, scene.planned.check, limit_s, nullptr);
      case Task::Kind::kExchange: return encode_job(WorkKind::kExchange, scene.description, limit_s, nullptr);
      case Task::Kind::kMethods: return encode_job(WorkKind::kMethods, scene.description, limit_s, nullptr);
      case Task::Kind::kPoint:
      case Task::Kind::kRestart: break;
    }
    return encode_job(WorkKind::kPoint, ledger_.point_of(task).description, limit_s,
                      ledger_.reference_of(task));
  }

  /// Stores and uses a result; runs in the study's process.
  void done(Task& task, const Outcome& outcome) {
    timed_runs_ = false;
    if (stopped()) return;  // The run may have been interrupted.
    task.done = true;
    if (task.is_point())
      keep(task, row_of(task, outcome));
    else
      keep(task, artefact_of(task, outcome));
    report(task);
  }

  template <typename Kept>
  void keep(const Task& task, const Kept& kept) {
    database_.put(kept);
    ledger_.take(task, kept);
  }

  store::StudyRun row_of(const Task& task, const Outcome& outcome) {
    PointRun run;
    if (outcome.end == Outcome::End::kDone)
      run = point_run_of(outcome.bytes);
    else
      run.status = status_of(outcome.end), run.reason = outcome.bytes;
    run.reference = ledger_.reference_used(task);
    store::StudyRun row = compare::row_of(run, options_.limit_s);
    const ComparePoint& point = ledger_.point_of(task);
    row.key = ledger_.key_of(task);
    row.repeat = task.repeat;
    row.scene = ledger_.out.scenes[task.scene].scene;
    row.label = point.label;
    row.integrator = point.integrator;
    row.setting_name = point.setting_name;
    row.setting = point.setting;
    return row;
  }

  store::StudyArtefact artefact_of(const Task& task, const Outcome& outcome) const {
    static const char* const kWhat[] = {"reference", "check", "point", "restart", "exchange", "methods"};
    store::StudyArtefact kept{ledger_.artefact_key(task),
                              kWhat[static_cast<int>(task.kind)],
                              to_string(status_of(outcome.end)),
                              "",
                              0.0,
                              ""};
    if (outcome.end != Outcome::End::kDone) {
      kept.reason = outcome.bytes;
    } else {
      kept.bytes = outcome.bytes;
      if (task.is_reference()) {
        const loop::RunResult result = run_of(outcome.bytes).result;
        kept.cpu_s = result.cpu_s;
        if (result.stopped) {
          kept.status = to_string(PointStatus::kOutOfTime);
          kept.reason =
              fmt::format("out of time: {:g} s (at t = {:.4g} s)", options_.reference_limit_s, result.time);
        } else if (!result.status.ok()) {
          kept.status = to_string(PointStatus::kFailed);
          kept.reason = result.status.message;
        }
      }
    }
    // A longer limit causes a new attempt.
    if (kept.status == to_string(PointStatus::kOutOfTime)) kept.cpu_s = options_.reference_limit_s;
    return kept;
  }

  void report(const Task& task) {
    if (!options_.progress) return;
    const auto finished =
        std::count_if(ledger_.tasks.begin(), ledger_.tasks.end(), [](const Task& t) { return t.done; });
    const std::string& scene = ledger_.out.scenes[task.scene].scene;
    std::string what = (task.is_reference() ? "reference of " : "charts of ") + scene;
    if (task.is_point()) {
      const ComparePoint& point = ledger_.point_of(task);
      what = fmt::format("{}: {} {} = {:g}", scene, point.label, point.setting_name, point.setting);
    }
    options_.progress(static_cast<double>(finished) / static_cast<double>(ledger_.tasks.size()), what);
  }

  const CompareOptions& options_;
  bool timed_runs_ = false;
  int jobs_;
  ProcessPool pool_;  ///< Before the database: where the pool cannot be created, no file has been opened.
  store::StudyDb database_;
  Ledger ledger_;
};

/// Acceptance limit of the error of a solver, relative to the error with the first (direct) solver of the
/// sequence.  Under error control, different rounding leads to different steps, and errors scatter by that
/// much.
constexpr double kSameError = 2.0;

/// Returns the fastest solver of each sequence tried, among those whose error is accepted against the first
/// (direct) one's.
SolverChoice fastest_of(const std::vector<ComparePoint>& trials) {
  SolverChoice out;
  std::map<std::string, const ComparePoint*> first, best;
  for (const ComparePoint& trial : trials) {
    if (trial.status != PointStatus::kOk) continue;
    const std::string label =
        trial.label.substr(0, trial.label.size() - trial_label("", trial.linear_solver).size());
    const double right = first.emplace(label, &trial).first->second->error.position_rel_l2,
                 error = trial.error.position_rel_l2;
    if (error > kSameError * right) continue;
    const ComparePoint*& fastest = best.emplace(label, &trial).first->second;
    if (trial.cpu_median_s <= fastest->cpu_median_s) fastest = &trial;
  }
  for (const auto& [label, trial] : best) out.by_label[label] = trial->linear_solver;
  return out;
}

}  // namespace

Comparison run(const std::vector<scene::Description>& scenes, const CompareOptions& options) {
  std::vector<SolverChoice> choices(
      scenes.size(), {options.linear_solvers == LinearSolvers::kSame ? options.linear_solver : ""});
  if (options.linear_solvers != LinearSolvers::kBest) return Study(scenes, options, choices).run();
  const Comparison tried = Study(scenes, options, choices, true).run();
  for (std::size_t s = 0; s < scenes.size(); ++s) choices[s] = fastest_of(tried.scenes[s].points);
  Comparison out = Study(scenes, options, choices).run();
  for (std::size_t s = 0; s < scenes.size(); ++s) out.scenes[s].trials = tried.scenes[s].points;
  out.reused += tried.reused;
  return out;
}

}  // namespace palpate::compare
