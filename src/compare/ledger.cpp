#include "ledger.h"

#include <algorithm>

#include "loop/result_key.h"
#include "palpate/core/error.h"

namespace palpate::compare {

Ledger::Ledger(const std::vector<scene::Description>& scenes, const CompareOptions& options,
               const std::vector<SolverChoice>& choices, bool trials)
    : options_(options), trials_(trials) {
  for (std::size_t s = 0; s < scenes.size(); ++s) plan(scenes[s], choices[s]);
  add_tasks();
}

void Ledger::plan(const scene::Description& d, const SolverChoice& choice) {
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
  work.push_back(std::move(own));
  out.scenes.push_back(std::move(comparison));
}

// Order: references; the first levels of all sequences over all scenes, then their second levels; further
// charts; repeats.
void Ledger::add_tasks() {
  std::size_t most = 0;
  for (std::size_t s = 0; s < work.size(); ++s) {
    tasks.push_back({Task::Kind::kPrimary, s});
    tasks.push_back({Task::Kind::kCheck, s});
    for (std::size_t p = 0; p < out.scenes[s].points.size(); ++p) most = std::max(most, level(s, p) + 1);
  }
  for (int repeat = 0; repeat < std::max(1, options_.repeats); ++repeat) {
    for (std::size_t r = 0; r < most; ++r)
      for (std::size_t s = 0; s < work.size(); ++s)
        for (std::size_t p = 0; p < out.scenes[s].points.size(); ++p)
          if (level(s, p) == r) tasks.push_back({Task::Kind::kPoint, s, p, repeat});
    if (repeat > 0 || trials_) continue;
    for (std::size_t s = 0; s < work.size(); ++s) {
      for (std::size_t p = 0; p < out.scenes[s].restarts.size(); ++p)
        tasks.push_back({Task::Kind::kRestart, s, p});
      if (!work[s].description.compare.exchange_periods_s.empty())
        tasks.push_back({Task::Kind::kExchange, s});
      if (!work[s].description.compare.contact_methods.empty()) tasks.push_back({Task::Kind::kMethods, s});
    }
  }
}

std::size_t Ledger::level(std::size_t s, std::size_t p) const {
  const auto& points = out.scenes[s].points;
  std::size_t n = 0;
  while (p > 0 && points[p - 1].label == points[p].label) --p, ++n;
  return n;
}
const ComparePoint* Ledger::coarser(const Task& task, std::size_t by) const {
  const auto& points = out.scenes[task.scene].points;
  return task.point >= by && points[task.point - by].label == points[task.point].label
             ? &points[task.point - by]
             : nullptr;
}

// Whether the two preceding levels both have errors that the reference does not resolve: nothing finer can be
// judged.
bool Ledger::is_at_the_end(const Task& task) const {
  const SceneComparison& scene = out.scenes[task.scene];
  const TrajectoryError& own = scene.reference.own_error;
  for (const std::size_t by : {std::size_t{1}, std::size_t{2}}) {
    const ComparePoint* before = coarser(task, by);
    if (!before || before->status != PointStatus::kOk ||
        !(before->error.position_rel_l2 < kResolution * own.position_rel_l2) ||
        (scene.tool && !(before->error.force_rms_n < kResolution * own.force_rms_n)))
      return false;
  }
  return true;
}

ReferenceUsed Ledger::reference_used(const Task& task) const {
  const SceneWork& own = work[task.scene];
  if (task.kind != Task::Kind::kPoint || (!own.primary.run && !own.check.run)) return ReferenceUsed::kNone;
  if (!own.primary.run) return ReferenceUsed::kCheck;
  if (!own.check.run) return ReferenceUsed::kPrimary;
  const ComparePoint& point = out.scenes[task.scene].points[task.point];
  const auto is_of = [&](const std::string& integrator) {
    const dynamics::StepperEntry* entry = find_stepper(integrator);
    return point.integrator == integrator || (entry && entry->traits.family == point.family);
  };
  return is_of(own.planned.made_with) && !is_of(own.planned.checked_with) ? ReferenceUsed::kCheck
                                                                          : ReferenceUsed::kPrimary;
}

const Trajectory* Ledger::reference_of(const Task& task) const {
  const SceneWork& own = work[task.scene];
  switch (reference_used(task)) {
    case ReferenceUsed::kPrimary: return &own.primary.run->trajectory;
    case ReferenceUsed::kCheck: return &own.check.run->trajectory;
    case ReferenceUsed::kNone: break;
  }
  return nullptr;
}

ComparePoint& Ledger::point_of(const Task& task) {
  SceneComparison& scene = out.scenes[task.scene];
  return task.kind == Task::Kind::kRestart ? scene.restarts[task.point] : scene.points[task.point];
}

const std::string& Ledger::key_of(const Task& task) const {
  const SceneWork& own = work[task.scene];
  return task.kind == Task::Kind::kRestart ? own.restart_keys[task.point] : own.point_keys[task.point];
}

std::string Ledger::artefact_key(const Task& task) const {
  const SceneWork& own = work[task.scene];
  const scene::CompareSpec& c = own.description.compare;
  switch (task.kind) {
    case Task::Kind::kPrimary: return own.primary_key;
    case Task::Kind::kCheck: return own.check_key;
    case Task::Kind::kExchange:
      return loop::result_key(own.description,
                              fmt::format("exchange {}", fmt::join(c.exchange_periods_s, " ")));
    default:
      return loop::result_key(own.description, fmt::format("methods {}", fmt::join(c.contact_methods, " ")));
  }
}

// ---- conditions for running a task ----

bool Ledger::is_ready(const Task& task) {
  if (task.kind != Task::Kind::kPoint) return true;
  if (!work[task.scene].reference_settled) return false;
  if (task.repeat > 0) return point_of(task).status != PointStatus::kMissing;
  const ComparePoint* before = coarser(task, 1);
  return !before || before->status != PointStatus::kMissing;
}

bool Ledger::is_pointless(const Task& task) {
  if (task.kind != Task::Kind::kPoint) return false;
  ComparePoint& point = point_of(task);
  if (task.repeat > 0) {
    if (point.status == PointStatus::kMissing) return false;  // Decided later.
    double spent = 0.0;
    for (double s : point.cpu_s) spent += s;
    return point.status != PointStatus::kOk || spent > 0.2 * options_.limit_s;
  }
  const ComparePoint* before = coarser(task, 1);
  if (!before || point.status != PointStatus::kMissing) return false;
  const auto settle_untried = [&point](PointStatus status, const std::string& reason) {
    point.status = status;
    point.reason = reason;
    point.error = no_distance();
  };
  if (before->status == PointStatus::kRefused)
    settle_untried(PointStatus::kRefused, before->reason);
  else if (before->status == PointStatus::kOutOfTime ||
           (before->status == PointStatus::kNotTried && before->reason != kNotNeeded))
    settle_untried(PointStatus::kNotTried, "not tried: a coarser level ran out of time");
  else if (point.open_ended && (before->reason == kNotNeeded || is_at_the_end(task)))
    settle_untried(PointStatus::kNotTried, kNotNeeded);
  return point.status != PointStatus::kMissing;
}

}  // namespace palpate::compare
