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
#include "palpate/compare/compare.h"
#include "palpate/core/error.h"
#include "report/comparison_words.h"
#include "report/run_report.h"
#include "report/table.h"
#include "report/work_precision.h"
#include "store/result_folder.h"

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
                                    const CompareArguments& arguments, const std::string& folder) {
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
  options.database = (fs::path(folder) / "study.sqlite").string();
  options.progress = [&progress](double fraction, const std::string& what) { progress(fraction, what); };
  options.stop = &stop_flag();
  if (arguments.fresh) fs::remove(options.database);
  return compare::run(scenes, options);
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

}  // namespace

int compare(const CompareArguments& arguments) {
  MissingOutputs missing;
  return missing.close(compare(arguments, missing));
}

int compare(const CompareArguments& arguments, MissingOutputs& missing) {
  const std::vector<scene::Description> scenes = scenes_of(arguments);
  const std::string folder =
      arguments.folder.empty() ? default_folder(default_name(scenes)) : arguments.folder;
  const store::ResultFolder mine(folder);

  const compare::Comparison comparison = compare_watched(scenes, arguments, folder);
  compare::write(comparison, folder);
  if (comparison.reused > 0)
    fmt::print("{} results are from earlier runs (--fresh repeats them)\n\n", comparison.reused);
  const fs::path points = fs::path(folder) / "compare.csv";
  const report::Table table = fs::exists(points) ? report::read_csv(points) : report::Table{};
  for (const compare::SceneComparison& scene : comparison.scenes) {
    print_reference(scene);
    const report::Table own = report::rows_where(table, "scene", scene.scene);
    if (own.rows.empty()) continue;
    print_trials(scene);
    print_points(scene);
    print_prices(own, scene.reference.own_error.position_rel_l2);
    print_restarts(scene);
    print_exchange(scene);
    print_methods(scene);
    fmt::print("{}\n\n", report::in_words(own, reference_of(scene.reference)));
  }
  fmt::print("{}\n", comparison.rules);
  if (!table.rows.empty()) {
    const report::RunReport written = report::write_run_report(folder);
    fmt::print("written: {}\n", written.page.string());
    missing.add(written);
  }
  if (!comparison.stopped) {
    add_missing(comparison, missing);
    return 0;
  }
  fmt::print(stderr, "palpate: stopped; the same command resumes from {}\n", folder);
  return kExitStopped;
}

}  // namespace palpate::cli
