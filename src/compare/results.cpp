#include <algorithm>
#include <map>
#include <set>

#include "ledger.h"
#include "palpate/core/error.h"

namespace palpate::compare {
namespace {

ReferenceRun reference_run_of(const store::StudyArtefact& kept) {
  if (kept.status != "ok") return {std::nullopt, kept.reason};
  return {run_of(kept.bytes), ""};
}

void summarise(ComparePoint& point, const TrajectoryError& own) {
  // NaN is never unresolved.
  point.unresolved = point.error.position_rel_l2 < kResolution * own.position_rel_l2;
  point.force_unresolved = point.error.force_rms_n < kResolution * own.force_rms_n;
  point.torque_unresolved = point.error.torque_rms_n_m < kResolution * own.torque_rms_n_m;
  if (point.cpu_s.empty()) return;
  std::vector<double> sorted = point.cpu_s;
  std::sort(sorted.begin(), sorted.end());
  point.cpu_min_s = sorted.front();
  point.cpu_max_s = sorted.back();
  const std::size_t n = sorted.size();
  point.cpu_median_s = 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
}

}  // namespace

void Ledger::take(const Task& task, const store::StudyRun& row) {
  const PointRun run = point_run_of(row);
  ComparePoint& point = point_of(task);
  if (run.status == PointStatus::kOk) point.cpu_s.push_back(run.result.cpu_s);
  if (task.repeat > 0) return;
  point.status = run.status;
  point.reason = run.reason;
  point.error = run.error;
  point.setup_s = run.setup_s;
  point.record_s = run.record_s;
  point.result = run.result;
  const PlannedReference& planned = work[task.scene].planned;
  if (run.reference != ReferenceUsed::kNone)
    point.against = run.reference == ReferenceUsed::kPrimary ? planned.made_with : planned.checked_with;
}

void Ledger::take(const Task& task, const store::StudyArtefact& kept) {
  SceneWork& own = work[task.scene];
  if (task.kind == Task::Kind::kPrimary)
    own.primary = reference_run_of(kept);
  else if (task.kind == Task::Kind::kCheck)
    own.check = reference_run_of(kept);
  else
    take_chart(task, kept);
}

void Ledger::take_chart(const Task& task, const store::StudyArtefact& kept) {
  SceneComparison& comparison = out.scenes[task.scene];
  const bool exchange = task.kind == Task::Kind::kExchange;
  const auto note = [&](const std::string& of, const std::string& why) {
    comparison.missing_charts.push_back({of, why});
  };
  if (kept.status != "ok") {
    note(exchange ? "the exchange period" : "the contact methods", kept.reason);
  } else if (exchange) {
    comparison.exchange = exchange_of(kept.bytes);
    if (!comparison.exchange.trouble.empty())
      note("the error of the exchange period", comparison.exchange.trouble);
    for (const ExchangePoint& point : comparison.exchange.points)
      if (!point.trouble.empty())
        note(fmt::format("the exchange period at {:g} s", point.exchange_period_s), point.trouble);
  } else {
    comparison.methods = methods_of(kept.bytes);
    for (const MethodPoint& point : comparison.methods)
      if (!point.trouble.empty()) note(fmt::format("the contact method \"{}\"", point.method), point.trouble);
    std::erase_if(comparison.methods, [](const MethodPoint& point) { return !point.trouble.empty(); });
  }
}

bool Ledger::is_complete(const Task& task, const store::StudyArtefact& kept) {
  if (task.is_reference()) return true;
  if (kept.status != "ok") return false;
  const auto good = [](const auto& point) { return point.trouble.empty(); };
  if (task.kind == Task::Kind::kExchange) {
    const ExchangeStudy study = exchange_of(kept.bytes);
    return study.trouble.empty() && std::all_of(study.points.begin(), study.points.end(), good);
  }
  const std::vector<MethodPoint> points = methods_of(kept.bytes);
  return std::all_of(points.begin(), points.end(), good);
}

void Ledger::settle_references() {
  for (std::size_t s = 0; s < work.size(); ++s) {
    SceneWork& own = work[s];
    if (own.reference_settled || !reference_tasks_done(s)) continue;
    own.reference_settled = true;
    out.scenes[s].reference = settle(own.planned, own.primary, own.check);
  }
}

bool Ledger::reference_tasks_done(std::size_t s) const {
  return std::all_of(tasks.begin(), tasks.end(),
                     [s](const Task& t) { return t.scene != s || !t.is_reference() || t.done; });
}

void Ledger::finish(int jobs) {
  for (SceneComparison& scene : out.scenes) {
    for (auto* points : {&scene.points, &scene.restarts})
      for (ComparePoint& point : *points) summarise(point, scene.reference.own_error);
    std::erase_if(scene.points, [](const ComparePoint& p) { return p.reason == kNotNeeded; });
    // A method that rejects the scene is listed once.
    std::set<std::string> refused;
    std::erase_if(scene.points, [&](const ComparePoint& p) {
      return p.status == PointStatus::kRefused && !refused.insert(p.label).second;
    });
    std::sort(scene.missing_charts.begin(), scene.missing_charts.end(),
              [](const MissingChart& a, const MissingChart& b) { return a.of < b.of; });
  }
  static const std::map<LinearSolvers, std::string> kSolvers = {
      {LinearSolvers::kSame, "All implicit methods solved their linear systems by {}."},
      {LinearSolvers::kBest,
       "Each implicit method used the linear solver that was fastest at one level of its refinement "
       "sequence."},
      {LinearSolvers::kNamed,
       "Each implicit method used the linear solver that the scene specifies, or its default."}};
  const std::string solvers =
      fmt::format(fmt::runtime(kSolvers.at(options_.linear_solvers)), options_.linear_solver);
  out.rules = fmt::format(
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
