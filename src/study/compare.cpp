#include "palpate/study/compare.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <thread>

#include "compare_codec.h"
#include "compare_key.h"
#include "compare_plan.h"
#include "compare_run.h"
#include "palpate/core/error.h"
#include "process_pool.h"

namespace palpate::study {
namespace {

using Outcome = ProcessPool::Outcome;

/// One run that is to be made.
struct Task {
  enum class Kind { kTruth, kCheck, kPoint, kRestart, kExchange, kMethods };
  Kind kind;
  std::size_t scene, point = 0;
  int repeat = 0;
  bool looked = false, started = false, done = false;  ///< looked: into the database
};

/// A scene on its way.
struct SceneWork {
  scene::Description description;
  PlannedReference planned;
  std::string truth_key, check_key;
  ReferenceRun truth, check;
  const Trajectory* reference = nullptr;   ///< what points are held against
  ReferenceUsed reference_used = ReferenceUsed::kNone;
  bool reference_settled = false;
  std::vector<std::string> point_keys, restart_keys;
};

/// The study as it proceeds.  All results pass through the database's rows, whether they were made now or before: a study that was killed and
/// started again gives the same table.
class Study {
 public:
  Study(const std::vector<scene::Description>& scenes, const CompareOptions& options)
      : options_(options), jobs_(options.jobs > 0 ? options.jobs : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
        database_(options.database.empty() ? ":memory:" : options.database, run_columns()) {
    for (const scene::Description& d : scenes) plan(d);
    add_tasks();
  }

  Comparison run() {
    ProcessPool pool(jobs_);
    while (!stopped()) {
      settle_references();
      bool open = false, moved = false;
      for (Task& task : tasks_) {
        if (!task.done) moved |= proceed(pool, task);
        open |= !task.done;
      }
      if (!open) break;
      if (moved) continue;  // what was settled makes others ready
      PALPATE_CHECK(!pool.idle(), "nothing runs, and nothing can be started");
      pool.wait(0.2);
    }
    out_.stopped = stopped();
    finish();
    return std::move(out_);
  }

 private:
  bool stopped() const { return options_.stop && options_.stop->load(); }

  void plan(const scene::Description& d) {
    SceneWork work;
    work.description = with_overrides(d, {});  // the text alone decides
    SceneComparison out;
    out.scene = d.name;
    out.path = d.path;
    out.tool = d.tool.has_value();
    out.points = plan_points(work.description, options_);
    out.restarts = plan_restarts(work.description, options_);
    work.planned = plan_reference(work.description, out.points);
    work.truth_key = result_key(work.planned.truth, "reference");
    work.check_key = result_key(work.planned.check, "reference");
    for (const ComparePoint& p : out.points) work.point_keys.push_back(result_key(p.description, "point " + work.truth_key + work.check_key));
    for (const ComparePoint& p : out.restarts) work.restart_keys.push_back(result_key(p.description, "restart"));
    work_.push_back(std::move(work));
    out_.scenes.push_back(std::move(out));
  }

  /// In the order in which they are wanted: references; the ladders' first rungs, then their second ones, over all scenes; further charts; repeats.
  void add_tasks() {
    std::size_t most = 0;
    for (std::size_t s = 0; s < work_.size(); ++s) {
      tasks_.push_back({Task::Kind::kTruth, s});
      tasks_.push_back({Task::Kind::kCheck, s});
      for (std::size_t p = 0; p < out_.scenes[s].points.size(); ++p) most = std::max(most, rung(s, p) + 1);
    }
    for (int repeat = 0; repeat < std::max(1, options_.repeats); ++repeat) {
      for (std::size_t r = 0; r < most; ++r)
        for (std::size_t s = 0; s < work_.size(); ++s)
          for (std::size_t p = 0; p < out_.scenes[s].points.size(); ++p)
            if (rung(s, p) == r) tasks_.push_back({Task::Kind::kPoint, s, p, repeat});
      if (repeat > 0) continue;
      for (std::size_t s = 0; s < work_.size(); ++s) {
        for (std::size_t p = 0; p < out_.scenes[s].restarts.size(); ++p) tasks_.push_back({Task::Kind::kRestart, s, p});
        if (!work_[s].description.compare.exchange_periods_s.empty()) tasks_.push_back({Task::Kind::kExchange, s});
        if (!work_[s].description.compare.contact_methods.empty()) tasks_.push_back({Task::Kind::kMethods, s});
      }
    }
  }

  /// How many rungs of the same ladder come before it.
  std::size_t rung(std::size_t s, std::size_t p) const {
    const auto& points = out_.scenes[s].points;
    std::size_t n = 0;
    while (p > 0 && points[p - 1].label == points[p].label) --p, ++n;
    return n;
  }
  /// The rung before it, or null.
  const ComparePoint* coarser(const Task& task) const {
    const auto& points = out_.scenes[task.scene].points;
    return task.point > 0 && points[task.point - 1].label == points[task.point].label ? &points[task.point - 1] : nullptr;
  }

  ComparePoint& point_of(const Task& task) {
    SceneComparison& scene = out_.scenes[task.scene];
    return task.kind == Task::Kind::kRestart ? scene.restarts[task.point] : scene.points[task.point];
  }
  const std::string& key_of(const Task& task) const {
    const SceneWork& work = work_[task.scene];
    return task.kind == Task::Kind::kRestart ? work.restart_keys[task.point] : work.point_keys[task.point];
  }
  std::string artefact_key(const Task& task) const {
    const SceneWork& work = work_[task.scene];
    const scene::CompareSpec& c = work.description.compare;
    switch (task.kind) {
      case Task::Kind::kTruth: return work.truth_key;
      case Task::Kind::kCheck: return work.check_key;
      case Task::Kind::kExchange: return result_key(work.description, fmt::format("exchange {}", fmt::join(c.exchange_periods_s, " ")));
      default: return result_key(work.description, fmt::format("methods {}", fmt::join(c.contact_methods, " ")));
    }
  }
  static bool is_point(const Task& task) { return task.kind == Task::Kind::kPoint || task.kind == Task::Kind::kRestart; }
  double limit_of(const Task& task) const { return is_point(task) ? options_.limit_s : options_.reference_limit_s; }

  /// Does what can be done for it now; true where that may let others proceed.
  bool proceed(ProcessPool& pool, Task& task) {
    if (task.started) return false;
    if (is_pointless(task)) return task.done = true;
    if (!is_ready(task)) return false;
    if (!task.looked) {
      task.looked = true;
      resume(task);
      if (task.done) return true;
    }
    if (!pool.has_room()) return false;
    start(pool, task);
    return true;
  }

  // ---- which task may run, and which is not worth it ----

  bool is_ready(const Task& task) {
    if (task.kind != Task::Kind::kPoint) return true;
    if (!work_[task.scene].reference_settled) return false;
    if (task.repeat > 0) return point_of(task).status != PointStatus::kMissing;
    const ComparePoint* before = coarser(task);
    return !before || before->status != PointStatus::kMissing;
  }

  /// Settles a point that needs no run of its own; true where the task is to be left out.
  bool is_pointless(const Task& task) {
    if (task.kind != Task::Kind::kPoint) return false;
    ComparePoint& point = point_of(task);
    if (task.repeat > 0) {
      if (point.status == PointStatus::kMissing) return false;  // later
      double spent = 0.0;
      for (double s : point.cpu_s) spent += s;
      return point.status != PointStatus::kOk || spent > 0.2 * options_.limit_s;
    }
    const ComparePoint* before = coarser(task);
    if (!before || point.status != PointStatus::kMissing) return false;
    if (before->status == PointStatus::kRefused)
      settle_untried(point, PointStatus::kRefused, before->reason);
    else if (before->status == PointStatus::kOutOfTime || before->status == PointStatus::kNotTried)
      settle_untried(point, PointStatus::kNotTried, "not tried: a coarser rung ran out of time");
    return point.status != PointStatus::kMissing;
  }

  static void settle_untried(ComparePoint& point, PointStatus status, const std::string& reason) {
    point.status = status;
    point.reason = reason;
    point.error = no_distance();
  }

  // ---- from an earlier study ----

  void resume(Task& task) {
    if (!is_point(task)) {
      const auto kept = database_.artefact(artefact_key(task));
      if (!kept || (kept->status == "out of time" && kept->cpu_s < limit_of(task))) return;
      task.started = task.done = true;
      take(task, *kept);
      ++out_.reused;
      return;
    }
    for (const store::StudyRun& row : database_.runs(key_of(task))) {
      const bool wants_more_time = row.status == "out of time" && study::limit_of(row) < options_.limit_s;
      const bool other_reference = task.kind == Task::Kind::kPoint && point_run_of(row).reference != work_[task.scene].reference_used;
      if (row.repeat != task.repeat || wants_more_time || other_reference) continue;
      task.started = task.done = true;
      take(task, row);
      ++out_.reused;
    }
  }

  // ---- running ----

  void start(ProcessPool& pool, Task& task) {
    task.started = true;
    Task* at = &task;
    pool.start([this, at](const std::atomic<bool>& late) { return work(*at, late); }, limit_of(task), [this, at](const Outcome& outcome) { done(*at, outcome); });
  }

  /// In the process of the run.
  std::string work(const Task& task, const std::atomic<bool>& late) {
    const SceneWork& scene = work_[task.scene];
    const double duration = scene.description.compare.duration_s;
    switch (task.kind) {
      case Task::Kind::kTruth: return bytes_of(run_once(scene.planned.truth, duration, &late));
      case Task::Kind::kCheck: return bytes_of(run_once(scene.planned.check, duration, &late));
      case Task::Kind::kExchange: return bytes_of(compare_exchange(scene.description, {{}, &late}));
      case Task::Kind::kMethods: return bytes_of(compare_contact_methods(scene.description, &late));
      case Task::Kind::kPoint:
      case Task::Kind::kRestart: break;
    }
    return bytes_of(run_point(point_of(task).description, options_.limit_s, task.kind == Task::Kind::kPoint ? scene.reference : nullptr, &late));
  }

  static PointStatus status_of(Outcome::End end) {
    switch (end) {
      case Outcome::End::kDone: return PointStatus::kOk;
      case Outcome::End::kError: return PointStatus::kRefused;
      case Outcome::End::kCrash: return PointStatus::kCrashed;
      case Outcome::End::kOutOfTime: return PointStatus::kOutOfTime;
    }
    return PointStatus::kCrashed;
  }

  /// In the study's own process: keeps the result, then uses it.
  void done(Task& task, const Outcome& outcome) {
    if (stopped()) return;  // it may have been cut short
    task.done = true;
    if (is_point(task)) {
      PointRun run;
      if (outcome.end == Outcome::End::kDone) run = point_run_of(outcome.bytes);
      else run.status = status_of(outcome.end), run.reason = outcome.bytes;
      run.reference = work_[task.scene].reference_used;
      store::StudyRun row = row_of(run, options_.limit_s);
      const ComparePoint& point = point_of(task);
      row.key = key_of(task);
      row.repeat = task.repeat;
      row.scene = out_.scenes[task.scene].scene;
      row.label = point.label;
      row.integrator = point.integrator;
      row.setting_name = point.setting_name;
      row.setting = point.setting;
      database_.put(row);
      take(task, row);
    } else {
      const store::StudyArtefact kept = artefact_of(task, outcome);
      database_.put(kept);
      take(task, kept);
    }
    report(task);
  }

  store::StudyArtefact artefact_of(const Task& task, const Outcome& outcome) const {
    static const char* const kWhat[] = {"reference", "check", "point", "restart", "exchange", "methods"};
    store::StudyArtefact kept{artefact_key(task), kWhat[static_cast<int>(task.kind)], to_string(status_of(outcome.end)), "", 0.0, ""};
    if (outcome.end != Outcome::End::kDone) {
      kept.reason = outcome.bytes;
    } else {
      kept.bytes = outcome.bytes;
      if (task.kind == Task::Kind::kTruth || task.kind == Task::Kind::kCheck) {
        const loop::RunResult result = run_of(outcome.bytes).result;
        kept.cpu_s = result.cpu_s;
        if (result.stopped) {
          kept.status = to_string(PointStatus::kOutOfTime);
          kept.reason = fmt::format("out of time: {:g} s (at t = {:.4g} s)", options_.reference_limit_s, result.time);
        } else if (!result.status.ok()) {
          kept.status = to_string(PointStatus::kFailed);
          kept.reason = result.status.message;
        }
      }
    }
    if (kept.status == to_string(PointStatus::kOutOfTime)) kept.cpu_s = options_.reference_limit_s;  // a longer limit tries again
    return kept;
  }

  void take(const Task& task, const store::StudyRun& row) {
    const PointRun run = point_run_of(row);
    ComparePoint& point = point_of(task);
    if (run.status == PointStatus::kOk) point.cpu_s.push_back(run.result.cpu_s);
    if (task.repeat > 0) return;
    point.status = run.status;
    point.reason = run.reason;
    point.error = run.error;
    point.result = run.result;
  }

  void take(const Task& task, const store::StudyArtefact& kept) {
    SceneWork& work = work_[task.scene];
    SceneComparison& out = out_.scenes[task.scene];
    const bool ok = kept.status == "ok";
    if (task.kind == Task::Kind::kTruth) {
      work.truth = reference_run_of(kept);
    } else if (task.kind == Task::Kind::kCheck) {
      work.check = reference_run_of(kept);
    } else if (!ok) {
      out.notes.push_back(fmt::format("no chart of {}: {}", task.kind == Task::Kind::kExchange ? "the exchange period" : "the contact methods", kept.reason));
    } else if (task.kind == Task::Kind::kExchange) {
      out.exchange = exchange_of(kept.bytes);
    } else {
      out.methods = methods_of(kept.bytes);
    }
  }

  static ReferenceRun reference_run_of(const store::StudyArtefact& kept) {
    if (kept.status != "ok") return {std::nullopt, kept.reason};
    return {run_of(kept.bytes), ""};
  }

  void report(const Task& task) {
    if (!options_.progress) return;
    const auto finished = std::count_if(tasks_.begin(), tasks_.end(), [](const Task& t) { return t.done; });
    std::string what = "reference of " + out_.scenes[task.scene].scene;
    if (is_point(task)) what = fmt::format("{}: {} {} = {:g}", out_.scenes[task.scene].scene, point_of(task).label, point_of(task).setting_name, point_of(task).setting);
    if (task.kind == Task::Kind::kExchange || task.kind == Task::Kind::kMethods) what = "charts of " + out_.scenes[task.scene].scene;
    options_.progress(static_cast<double>(finished) / static_cast<double>(tasks_.size()), what);
  }

  // ---- the reference ----

  /// Once a scene's two reference runs have ended: what is the truth, and how far can it be trusted?
  void settle_references() {
    for (std::size_t s = 0; s < work_.size(); ++s) {
      SceneWork& work = work_[s];
      if (work.reference_settled || !reference_tasks_done(s)) continue;
      work.reference_settled = true;
      out_.scenes[s].reference = settle(work.planned, work.truth, work.check);
      if (!out_.scenes[s].reference.available) continue;
      work.reference_used = work.truth.run ? ReferenceUsed::kTruth : ReferenceUsed::kCheck;
      work.reference = work.truth.run ? &work.truth.run->trajectory : &work.check.run->trajectory;
    }
  }
  bool reference_tasks_done(std::size_t s) const {
    return std::all_of(tasks_.begin(), tasks_.end(), [s](const Task& t) { return t.scene != s || (t.kind != Task::Kind::kTruth && t.kind != Task::Kind::kCheck) || t.done; });
  }

  // ---- the end ----

  void finish() {
    for (SceneComparison& scene : out_.scenes) {
      for (auto* points : {&scene.points, &scene.restarts})
        for (ComparePoint& point : *points) summarise(point, scene.reference.own_error);
      // A method that refuses the scene says so once.
      std::set<std::string> refused;
      std::erase_if(scene.points, [&](const ComparePoint& p) { return p.status == PointStatus::kRefused && !refused.insert(p.label).second; });
      std::sort(scene.notes.begin(), scene.notes.end());
    }
    out_.rules = fmt::format("Each run had a process of its own, {} at a time, and at most {:g} CPU seconds ({:g} for references and further charts). A point was run "
                             "up to {} times, again only while its runs together took less than {:g} CPU seconds, the repeats interleaved over all points; times are medians.",
                             jobs_, options_.limit_s, options_.reference_limit_s, options_.repeats, 0.2 * options_.limit_s);
  }

  static void summarise(ComparePoint& point, const TrajectoryError& own) {
    point.below_reference = point.error.position_rel_l2 <= own.position_rel_l2;  // NaN is never below
    point.force_below_reference = point.error.force_rms_n <= own.force_rms_n;
    point.torque_below_reference = point.error.torque_rms_n_m <= own.torque_rms_n_m;
    if (point.cpu_s.empty()) return;
    std::vector<double> sorted = point.cpu_s;
    std::sort(sorted.begin(), sorted.end());
    point.cpu_min_s = sorted.front();
    point.cpu_max_s = sorted.back();
    const std::size_t n = sorted.size();
    point.cpu_median_s = 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
  }

  const CompareOptions& options_;
  int jobs_;
  store::StudyDb database_;
  std::vector<SceneWork> work_;
  std::vector<Task> tasks_;
  Comparison out_;
};

}  // namespace

Comparison compare(const std::vector<scene::Description>& scenes, const CompareOptions& options) { return Study(scenes, options).run(); }

}  // namespace palpate::study
