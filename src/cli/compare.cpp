#include "compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "cli/missing_outputs.h"
#include "cli/paths.h"
#include "cli/progress.h"
#include "cli/scene_of.h"
#include "cli/stop.h"
#include "compare_tables.h"
#include "experiments/compare/run_comparison.h"
#include "palpate/core/error.h"
#include "palpate/experiments/compare.h"
#include "report/comparison_words.h"
#include "report/run_report.h"
#include "report/table.h"
#include "report/work_precision.h"

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

/// Returns the scenes with the changes of the command line applied to their text: results are stored under
/// that text.
std::vector<scene::Description> scenes_of(const CompareArguments& arguments) {
  std::vector<scene::Description> out;
  for (const std::string& name : arguments.scenes) {
    SceneArguments one{name, arguments.overrides, ""};
    if (arguments.duration_s > 0.0)
      one.overrides.push_back(fmt::format("compare.duration_s={}", arguments.duration_s));
    out.push_back(scene_of(one));
    const auto same = std::count_if(out.begin(), out.end(),
                                    [&](const scene::Description& d) { return d.name == out.back().name; });
    if (same > 1) fail("two scenes have the name \"{}\"; change the [scene] name of one", out.back().name);
  }
  return out;
}

std::string default_name(const std::vector<scene::Description>& scenes) {
  std::string out = "compare";
  for (const scene::Description& d : scenes) out.append("-").append(short_name(d));
  return out;
}

compare::Comparison compare_watched(const std::vector<scene::Description>& scenes,
                                    const CompareArguments& arguments, const experiments::Place& place,
                                    experiments::EngineOutcome& outcome) {
  Progress progress("reference runs");
  compare::CompareOptions options;
  options.repeats = arguments.repeats;
  options.limit_s = arguments.limit_s;
  options.reference_limit_s = arguments.reference_limit_s;
  options.jobs = arguments.jobs;
  options.integrators = arguments.integrators;
  options.all = arguments.all;
  options.linear_solvers = arguments.linear_solver == "best"    ? compare::LinearSolvers::kBest
                           : arguments.linear_solver == "named" ? compare::LinearSolvers::kNamed
                                                                : compare::LinearSolvers::kSame;
  if (options.linear_solvers == compare::LinearSolvers::kSame)
    options.linear_solver = arguments.linear_solver;
  options.progress = [&progress](double fraction, const std::string& what) { progress(fraction, what); };
  options.stop = &stop_flag();
  return compare::run(scenes, options, place, outcome);
}

/// Returns a scene's name, or the absolute path of its file.
std::string anywhere(const std::string& scene) {
  return fs::is_regular_file(scene) ? fs::absolute(scene).lexically_normal().string() : scene;
}

report::ReferenceError reference_of(const compare::Reference& r) {
  return {r.own_error.position_rel_l2, r.own_error.force_rms_n, r.own_error.torque_rms_n_m, r.peak_force_n,
          r.peak_torque_n_m};
}

/// Adds the missing outputs of a finished comparison.
void add_missing(const compare::Comparison& comparison, MissingOutputs& missing) {
  for (const compare::SceneComparison& scene : comparison.scenes) {
    if (!scene.reference.trouble.empty())
      missing.add("checked reference of " + scene.scene, scene.reference.trouble);
    for (const compare::MissingChart& chart : scene.missing_charts)
      missing.add(fmt::format("chart of {} of {}", chart.of, scene.scene), chart.why);
  }
}

/// Writes and prints the tables and the report.
void show(const compare::Comparison& comparison, const std::string& folder, MissingOutputs& missing) {
  compare::write(comparison, folder);
  const fs::path points = fs::path(folder) / "compare.csv";
  const report::Table table = fs::exists(points) ? report::read_csv(points) : report::Table{};
  for (const compare::SceneComparison& scene : comparison.scenes) {
    print_reference(scene);
    const report::Table own = report::rows_where(table, "scene", scene.scene);
    if (own.rows.empty()) continue;
    fmt::print("{}\n\n", report::in_words(own, reference_of(scene.reference)));
    print_trials(scene);
    print_points(scene);
    print_prices(own, scene.reference.own_error.position_rel_l2);
    print_restarts(scene);
    print_exchange(scene);
    print_methods(scene);
  }
  fmt::print("{}\n", comparison.rules);
  if (table.rows.empty()) return;
  const report::RunReport written = report::write_run_report(folder);
  fmt::print("written: {}\n", written.page.string());
  report::add_missing(written, missing);
}

}  // namespace

scene::Description one_scene_of(const CompareArguments& arguments, const char* option) {
  if (arguments.scenes.size() != 1)
    fail("compare {} takes one SCENE, not {}", option, arguments.scenes.size());
  return scenes_of(arguments).front();
}

TaskFolder::Use use_of(const CompareArguments& a, const std::string& folder) {
  TaskFolder::Use use{folder, a.fresh, false, "comparison", {}};
  experiments::ArrayJob& job = use.job;
  job.command = "compare";
  const auto option = [&job](const char* name, const std::string& value) {
    job.words.insert(job.words.end(), {name, value});
  };
  for (const std::string& scene : a.scenes) {
    job.words.push_back(anywhere(scene));
    job.subject += (job.subject.empty() ? "" : " ") + scene;
  }
  job.name = "compare " + job.subject;
  for (const std::string& one : a.overrides) option("--set", one);
  for (const std::string& one : a.integrators) option("--integrator", one);
  if (a.duration_s > 0.0) option("--duration-s", fmt::format("{}", a.duration_s));
  option("--repeats", fmt::format("{}", a.repeats));
  option("--limit-s", fmt::format("{}", a.limit_s));
  option("--reference-limit-s", fmt::format("{}", a.reference_limit_s));
  if (a.haptic) job.words.emplace_back("--haptic");
  if (a.mesh) job.words.emplace_back("--mesh");
  if (a.all) job.words.emplace_back("--all");
  if (!a.haptic) option("--linear-solver", a.linear_solver);
  return use;
}

int compare(const CompareArguments& arguments) {
  MissingOutputs missing;
  return missing.close(compare(arguments, missing));
}

int compare(const CompareArguments& arguments, MissingOutputs& missing) {
  const std::vector<scene::Description> scenes = scenes_of(arguments);
  const std::string folder =
      arguments.folder.empty() ? default_folder(default_name(scenes)) : arguments.folder;
  TaskFolder tasks(arguments.array, use_of(arguments, folder));

  experiments::EngineOutcome outcome;
  const compare::Comparison comparison = compare_watched(scenes, arguments, tasks.place(), outcome);
  if (tasks.ends_early()) return tasks.end(outcome);
  tasks.add_missing(outcome, missing);
  TaskFolder::print_reused(outcome.reused);
  // Without scenes, earlier tables stay as they are.
  if (!comparison.scenes.empty()) show(comparison, folder, missing);
  if (!comparison.stopped) {
    add_missing(comparison, missing);
    return 0;
  }
  fmt::print(stderr, "palpate: stopped; the same command resumes from {}\n", folder);
  return kExitStopped;
}

}  // namespace palpate::cli
