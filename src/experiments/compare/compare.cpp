#include "palpate/experiments/compare.h"

#include <map>

#include "experiments/compare/comparison_tasks.h"
#include "experiments/compare/run_comparison.h"

namespace palpate::compare {
namespace {

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
    if (trial.status != Status::kOk) continue;
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
  ProcessPool::prepare();  // Before a file is opened.
  experiments::ResultStore store;
  if (!options.folder.empty()) store = experiments::ResultStore::here(options.folder, false);
  experiments::EngineOutcome outcome;
  return run(scenes, options, {&store}, outcome);
}

Comparison run(const std::vector<scene::Description>& scenes, const CompareOptions& options,
               const experiments::Place& place, experiments::EngineOutcome& outcome) {
  experiments::EngineOptions engine;
  engine.jobs = experiments::jobs_or_cores(options.jobs);
  engine.stop = options.stop;
  engine.progress = options.progress;
  std::vector<SolverChoice> choices(
      scenes.size(), {options.linear_solvers == LinearSolvers::kSame ? options.linear_solver : ""});
  std::vector<std::vector<ComparePoint>> tried(scenes.size());
  if (options.linear_solvers == LinearSolvers::kBest) {
    ComparisonTasks trials(scenes, options, choices, true);
    outcome = experiments::run(trials, place, engine);
    Comparison done = trials.finish();
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      tried[s] = std::move(done.scenes[s].points);
      choices[s] = fastest_of(tried[s]);
    }
    // An array job ran these trials, or has to finish them: the sequences are not known before.
    const bool planned = !place.plan.empty() && !outcome.other_plan;
    if (planned || (place.submit && !outcome.complete)) {
      done.scenes.clear();
      done.stopped = outcome.stopped;
      return done;
    }
    for (experiments::LostTask& one : outcome.lost) one.why = "trial of a linear solver: " + one.why;
  }
  ComparisonTasks tasks(scenes, options, choices, false);
  const experiments::EngineOutcome of_trials = outcome;
  outcome = experiments::run(tasks, place, engine);
  outcome.reused += of_trials.reused;
  outcome.lost.insert(outcome.lost.begin(), of_trials.lost.begin(), of_trials.lost.end());
  Comparison out = tasks.finish();
  for (std::size_t s = 0; s < scenes.size(); ++s) out.scenes[s].trials = std::move(tried[s]);
  out.reused = static_cast<long>(outcome.reused);
  out.stopped = outcome.stopped;
  return out;
}

}  // namespace palpate::compare
