#include <algorithm>
#include <map>
#include <set>

#include "core/archive_bytes.h"
#include "experiments/compare/comparison_tasks.h"
#include "experiments/compare/methods.h"
#include "experiments/median.h"
#include "palpate/core/error.h"

namespace palpate::compare {
namespace {

void summarise(ComparePoint& point, const TrajectoryError& own) {
  // NaN is never unresolved.
  point.unresolved = point.error.position_rel_l2 < kResolution * own.position_rel_l2;
  point.force_unresolved = point.error.force_rms_n < kResolution * own.force_rms_n;
  point.torque_unresolved = point.error.torque_rms_n_m < kResolution * own.torque_rms_n_m;
  if (point.cpu_s.empty()) return;
  const auto [least, largest] = std::minmax_element(point.cpu_s.begin(), point.cpu_s.end());
  point.cpu_min_s = *least;
  point.cpu_max_s = *largest;
  point.cpu_median_s = experiments::median(point.cpu_s);
}

}  // namespace

void ComparisonTasks::take(std::size_t i, const experiments::Result& result) {
  const Task& task = tasks_[i];
  if (task.is_reference())
    take_reference(task, result);
  else if (task.is_point())
    take_point(task, result);
  else
    take_chart(task, result);
}

void ComparisonTasks::take_reference(const Task& task, const experiments::Result& result) {
  SceneWork& own = work_[task.scene];
  ReferenceRun& run = task.kind == Task::Kind::kPrimary ? own.primary : own.check;
  if (result.status == Status::kOk)
    run.run = restored<Run>(result.bytes);
  else
    run.trouble = result.reason;
  if (++own.references_taken < 2) return;
  own.reference_settled = true;
  out_.scenes[task.scene].reference = settle(own.planned, own.primary, own.check);
}

void ComparisonTasks::take_point(const Task& task, const experiments::Result& result) {
  ComparePoint& point = point_of(task);
  PointRun run;
  if (!result.bytes.empty()) run = restored<PointRun>(result.bytes);
  if (result.status == Status::kOk) point.cpu_s.push_back(run.result.cpu_s);
  if (task.repeat > 0) return;
  // A process that was killed is a crash in this table, and runs again in the next call.
  point.status = result.status == Status::kMissing ? Status::kCrashed : result.status;
  point.reason = result.reason;
  point.error = run.error;
  point.setup_s = run.setup_s;
  point.record_s = run.record_s;
  point.result = run.result;
  const PlannedReference& planned = work_[task.scene].planned;
  const ReferenceUsed used = reference_used(task);
  if (used != ReferenceUsed::kNone)
    point.against = used == ReferenceUsed::kPrimary ? planned.made_with : planned.checked_with;
}

void ComparisonTasks::take_chart(const Task& task, const experiments::Result& result) {
  SceneComparison& comparison = out_.scenes[task.scene];
  const bool exchange = task.kind == Task::Kind::kExchange;
  const auto note = [&](const std::string& of, const std::string& why) {
    comparison.missing_charts.push_back({of, why});
  };
  if (result.status != Status::kOk)
    note(exchange ? "the exchange period" : "the contact methods", result.reason);
  if (result.bytes.empty()) return;
  if (exchange) {
    comparison.exchange = restored<ExchangeStudy>(result.bytes);
    if (!comparison.exchange.trouble.empty())
      note("the error of the exchange period", comparison.exchange.trouble);
    for (const ExchangePoint& point : comparison.exchange.points)
      if (!point.trouble.empty())
        note(fmt::format("the exchange period at {:g} s", point.exchange_period_s), point.trouble);
  } else {
    comparison.methods = restored<Methods>(result.bytes).points;
    for (const MethodPoint& point : comparison.methods)
      if (!point.trouble.empty()) note(fmt::format("the contact method \"{}\"", point.method), point.trouble);
    std::erase_if(comparison.methods, [](const MethodPoint& point) { return !point.trouble.empty(); });
  }
}

bool ComparisonTasks::is_final(std::size_t i, const experiments::Result& result) {
  const Task& task = tasks_[i];
  if (task.is_reference() || task.is_point() || result.status == Status::kOutOfTime) return true;
  if (result.status != Status::kOk) return false;
  const auto good = [](const auto& point) { return point.trouble.empty(); };
  if (task.kind == Task::Kind::kExchange) {
    const auto study = restored<ExchangeStudy>(result.bytes);
    return study.trouble.empty() && std::all_of(study.points.begin(), study.points.end(), good);
  }
  const auto methods = restored<Methods>(result.bytes);
  return std::all_of(methods.points.begin(), methods.points.end(), good);
}

Comparison ComparisonTasks::finish() {
  for (SceneComparison& scene : out_.scenes) {
    for (auto* points : {&scene.points, &scene.restarts})
      for (ComparePoint& point : *points) summarise(point, scene.reference.own_error);
    std::erase_if(scene.points, [](const ComparePoint& p) { return p.reason == kNotNeeded; });
    // A method that rejects the scene is listed once.
    std::set<std::string> refused;
    std::erase_if(scene.points, [&](const ComparePoint& p) {
      return p.status == Status::kRefused && !refused.insert(p.label).second;
    });
    std::sort(scene.missing_charts.begin(), scene.missing_charts.end(),
              [](const MissingChart& a, const MissingChart& b) { return a.of < b.of; });
  }
  out_.rules = rules();
  return std::move(out_);
}

std::string ComparisonTasks::rules() const {
  const int jobs = experiments::jobs_or_cores(options_.jobs);
  static const std::map<LinearSolvers, std::string> kSolvers = {
      {LinearSolvers::kSame, "All implicit methods solved their linear systems by {}."},
      {LinearSolvers::kBest,
       "Each implicit method used the linear solver that was fastest at one level of its refinement "
       "sequence."},
      {LinearSolvers::kNamed,
       "Each implicit method used the linear solver that the scene specifies, or its default."}};
  const std::string solvers =
      fmt::format(fmt::runtime(kSolvers.at(options_.linear_solvers)), options_.linear_solver);
  return fmt::format(
      "{} Each run had a separate process, {}, and at most {:g} CPU seconds ({:g} for references and further "
      "charts). A point was run up to {} times, as long as its runs took less than {:g} CPU seconds in "
      "total, the repeats interleaved over all points; times are medians of the loop's CPU time, without "
      "assembly and recording.",
      solvers,
      options_.jobs > 0 ? fmt::format("{} at a time", jobs)
                        : fmt::format("references {} at a time, all others one at a time", jobs),
      options_.limit_s, options_.reference_limit_s, options_.repeats, 0.2 * options_.limit_s);
}

}  // namespace palpate::compare
