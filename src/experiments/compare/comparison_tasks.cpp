#include "experiments/compare/comparison_tasks.h"

#include <algorithm>

#include "experiments/compare/task_process.h"
#include "loop/result_key.h"
#include "palpate/core/error.h"

namespace palpate::compare {

ComparisonTasks::ComparisonTasks(const std::vector<scene::Description>& scenes, const CompareOptions& options,
                                 const std::vector<SolverChoice>& choices, bool trials)
    : options_(options), trials_(trials) {
  for (std::size_t s = 0; s < scenes.size(); ++s) plan(scenes[s], choices[s]);
  add_tasks();
}

void ComparisonTasks::plan(const scene::Description& d, const SolverChoice& choice) {
  SceneWork own;
  own.description = with_overrides(d, {});  // Only the text counts.
  SceneComparison comparison;
  comparison.scene = d.name;
  comparison.path = d.path;
  comparison.tool = d.tool.has_value();
  comparison.points =
      trials_ ? plan_trials(own.description, options_) : plan_points(own.description, options_, choice);
  if (!trials_) comparison.restarts = plan_restarts(own.description, options_, choice);
  own.planned = plan_reference(own.description, comparison.points);
  own.primary_key = loop::result_key(own.planned.primary, "reference");
  own.check_key = loop::result_key(own.planned.check, "reference");
  for (const ComparePoint& p : comparison.points)
    own.point_keys.push_back(loop::result_key(p.description, "point " + own.primary_key + own.check_key));
  for (const ComparePoint& p : comparison.restarts)
    own.restart_keys.push_back(loop::result_key(p.description, "restart"));
  const scene::CompareSpec& c = own.description.compare;
  own.exchange_key =
      loop::result_key(own.description, fmt::format("exchange {}", fmt::join(c.exchange_periods_s, " ")));
  own.methods_key =
      loop::result_key(own.description, fmt::format("methods {}", fmt::join(c.contact_methods, " ")));
  work_.push_back(std::move(own));
  out_.scenes.push_back(std::move(comparison));
}

// Order: references; the first levels of all sequences over all scenes, then their second levels; further
// charts; repeats.
void ComparisonTasks::add_tasks() {
  std::size_t most = 0;
  for (std::size_t s = 0; s < work_.size(); ++s) {
    add_task({Task::Kind::kPrimary, s});
    add_task({Task::Kind::kCheck, s});
    for (std::size_t p = 0; p < out_.scenes[s].points.size(); ++p) most = std::max(most, level(s, p) + 1);
  }
  for (int repeat = 0; repeat < std::max(1, options_.repeats); ++repeat) {
    for (std::size_t r = 0; r < most; ++r)
      for (std::size_t s = 0; s < work_.size(); ++s)
        for (std::size_t p = 0; p < out_.scenes[s].points.size(); ++p)
          if (level(s, p) == r) add_task({Task::Kind::kPoint, s, p, repeat});
    if (repeat > 0 || trials_) continue;
    for (std::size_t s = 0; s < work_.size(); ++s) {
      for (std::size_t p = 0; p < out_.scenes[s].restarts.size(); ++p) add_task({Task::Kind::kRestart, s, p});
      if (!work_[s].description.compare.exchange_periods_s.empty()) add_task({Task::Kind::kExchange, s});
      if (!work_[s].description.compare.contact_methods.empty()) add_task({Task::Kind::kMethods, s});
    }
  }
}

void ComparisonTasks::add_task(Task task) {
  task.group = tasks_.size();
  if (task.kind == Task::Kind::kPoint)
    task.group = groups_.emplace(std::pair{task.scene, point_of(task).label}, task.group).first->second;
  tasks_.push_back(task);
}

std::size_t ComparisonTasks::level(std::size_t s, std::size_t p) const {
  const auto& points = out_.scenes[s].points;
  std::size_t n = 0;
  while (p > 0 && points[p - 1].label == points[p].label) --p, ++n;
  return n;
}

const ComparePoint* ComparisonTasks::coarser(const Task& task, std::size_t by) const {
  const auto& points = out_.scenes[task.scene].points;
  return task.point >= by && points[task.point - by].label == points[task.point].label
             ? &points[task.point - by]
             : nullptr;
}

// Whether the two preceding levels both have errors that the reference does not resolve: nothing finer can be
// judged.
bool ComparisonTasks::is_at_the_end(const Task& task) const {
  const SceneComparison& scene = out_.scenes[task.scene];
  const TrajectoryError& own = scene.reference.own_error;
  for (const std::size_t by : {std::size_t{1}, std::size_t{2}}) {
    const ComparePoint* before = coarser(task, by);
    if (!before || before->status != Status::kOk ||
        !(before->error.position_rel_l2 < kResolution * own.position_rel_l2) ||
        (scene.tool && !(before->error.force_rms_n < kResolution * own.force_rms_n)))
      return false;
  }
  return true;
}

ComparisonTasks::ReferenceUsed ComparisonTasks::reference_used(const Task& task) const {
  const SceneWork& own = work_[task.scene];
  if (task.kind != Task::Kind::kPoint || (!own.primary.run && !own.check.run)) return ReferenceUsed::kNone;
  if (!own.primary.run) return ReferenceUsed::kCheck;
  if (!own.check.run) return ReferenceUsed::kPrimary;
  const ComparePoint& point = out_.scenes[task.scene].points[task.point];
  const auto is_of = [&](const std::string& integrator) {
    const dynamics::StepperEntry* entry = find_stepper(integrator);
    return point.integrator == integrator || (entry && entry->traits.family == point.family);
  };
  return is_of(own.planned.made_with) && !is_of(own.planned.checked_with) ? ReferenceUsed::kCheck
                                                                          : ReferenceUsed::kPrimary;
}

const Trajectory* ComparisonTasks::reference_of(const Task& task) const {
  const SceneWork& own = work_[task.scene];
  switch (reference_used(task)) {
    case ReferenceUsed::kPrimary: return &own.primary.run->trajectory;
    case ReferenceUsed::kCheck: return &own.check.run->trajectory;
    case ReferenceUsed::kNone: break;
  }
  return nullptr;
}

ComparePoint& ComparisonTasks::point_of(const Task& task) {
  SceneComparison& scene = out_.scenes[task.scene];
  return task.kind == Task::Kind::kRestart ? scene.restarts[task.point] : scene.points[task.point];
}

std::string ComparisonTasks::key_of(const Task& task) const {
  const SceneWork& own = work_[task.scene];
  switch (task.kind) {
    case Task::Kind::kPrimary: return own.primary_key;
    case Task::Kind::kCheck: return own.check_key;
    case Task::Kind::kExchange: return own.exchange_key;
    case Task::Kind::kMethods: return own.methods_key;
    case Task::Kind::kRestart: return own.restart_keys[task.point];
    case Task::Kind::kPoint: break;
  }
  return fmt::format("{} reference {} repeat {}", own.point_keys[task.point],
                     static_cast<int>(reference_used(task)), task.repeat);
}

// ---- tasks of the engine ----

experiments::Task ComparisonTasks::task(std::size_t i) {
  static const char* const kKinds[] = {"reference", "check", "point", "restart", "exchange", "methods"};
  const Task& one = tasks_[i];
  const bool alone = options_.jobs <= 0 && !one.is_reference();
  const int threads = work_[one.scene].description.integrator.threads;
  return {kKinds[static_cast<int>(one.kind)],
          key_of(one),
          progress_text(i),
          run_job,
          limit_of(one),
          alone,
          std::max(1, threads)};
}

std::string ComparisonTasks::input(std::size_t i) {
  const Task& one = tasks_[i];
  const SceneWork& scene = work_[one.scene];
  const double limit_s = limit_of(one);
  switch (one.kind) {
    case Task::Kind::kPrimary:
      return encode_job(WorkKind::kReference, scene.planned.primary, limit_s, nullptr);
    case Task::Kind::kCheck: return encode_job(WorkKind::kReference, scene.planned.check, limit_s, nullptr);
    case Task::Kind::kExchange: return encode_job(WorkKind::kExchange, scene.description, limit_s, nullptr);
    case Task::Kind::kMethods: return encode_job(WorkKind::kMethods, scene.description, limit_s, nullptr);
    case Task::Kind::kPoint:
    case Task::Kind::kRestart: break;
  }
  return encode_job(WorkKind::kPoint, point_of(one).description, limit_s, reference_of(one));
}

std::string ComparisonTasks::progress_text(std::size_t i) {
  const Task& one = tasks_[i];
  const std::string& scene = out_.scenes[one.scene].scene;
  if (!one.is_point()) return (one.is_reference() ? "reference of " : "charts of ") + scene;
  const ComparePoint& point = point_of(one);
  return fmt::format("{}: {} {} = {:g}", scene, point.label, point.setting_name, point.setting);
}

std::string ComparisonTasks::key() {
  std::string keys = trials_ ? "trials" : "";
  for (const SceneWork& own : work_)
    for (const std::vector<std::string>& list :
         {std::vector{own.primary_key, own.check_key, own.exchange_key, own.methods_key}, own.point_keys,
          own.restart_keys})
      for (const std::string& one : list) keys += one;
  return experiments::key_of({"compare", fmt::format("{}", options_.repeats), keys});
}

// ---- conditions for running a task ----

bool ComparisonTasks::is_ready(std::size_t i) {
  const Task& task = tasks_[i];
  if (task.kind != Task::Kind::kPoint) return true;
  if (!work_[task.scene].reference_settled) return false;
  if (task.repeat > 0) return point_of(task).status != Status::kMissing;
  const ComparePoint* before = coarser(task, 1);
  return !before || before->status != Status::kMissing;
}

bool ComparisonTasks::is_pointless(const Task& task) {
  if (task.kind != Task::Kind::kPoint) return false;
  ComparePoint& point = point_of(task);
  if (task.repeat > 0) {
    if (point.status == Status::kMissing) return false;  // Decided later.
    double spent = 0.0;
    for (double s : point.cpu_s) spent += s;
    return point.status != Status::kOk || spent > 0.2 * options_.limit_s;
  }
  const ComparePoint* before = coarser(task, 1);
  if (!before || point.status != Status::kMissing) return false;
  const auto settle_untried = [&point](Status status, const std::string& reason) {
    point.status = status;
    point.reason = reason;
    point.error = no_distance();
  };
  if (before->status == Status::kRefused)
    settle_untried(Status::kRefused, before->reason);
  else if (before->status == Status::kOutOfTime ||
           (before->status == Status::kNotTried && before->reason != kNotNeeded))
    settle_untried(Status::kNotTried, "not tried: a coarser level ran out of time");
  else if (point.open_ended && (before->reason == kNotNeeded || is_at_the_end(task)))
    settle_untried(Status::kNotTried, kNotNeeded);
  return point.status != Status::kMissing;
}

}  // namespace palpate::compare
