#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "cli/missing_outputs.h"
#include "cli/model_cache.h"
#include "cli/paths.h"
#include "cli/progress.h"
#include "cli/scene_of.h"
#include "cli/stop.h"
#include "compare.h"
#include "compare_tables.h"
#include "experiments/compare/mesh.h"
#include "palpate/core/error.h"
#include "report/run_report.h"
#include "report/table.h"
#include "store/summary.h"

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;
using compare::MeshComparison;
using compare::MeshLevel;
using compare::MeshVariable;
using Rows = std::vector<std::vector<std::string>>;

MeshComparison compare_levels_watched(const scene::Description& scene, const CompareArguments& a,
                                      const std::string& folder, const experiments::Place& place,
                                      experiments::EngineOutcome& outcome) {
  Progress progress("levels");
  compare::MeshOptions options;
  options.levels = a.levels;
  options.coarser = a.coarser;
  options.make_model = make_model_at;
  options.limit_s = a.limit_s;
  options.jobs = a.jobs;
  options.folder = folder;
  options.progress = [&progress](double fraction, const std::string& what) { progress(fraction, what); };
  options.stop = &stop_flag();
  return compare::compare_mesh(scene, options, place, outcome);
}

std::string divisions_text(int divisions) {
  if (divisions == 0) return "the scene's";
  const double factor = std::ldexp(1.0, std::abs(divisions));
  return divisions > 0 ? fmt::format("1/{:g}", factor) : fmt::format("{:g}", factor);
}

std::string figure_text(double value) { return std::isfinite(value) ? fmt::format("{:.5g}", value) : "-"; }

std::string percent_of(double part, double whole) {
  return std::isfinite(part) && whole > 0.0 ? fmt::format("{:.2g}", 100.0 * part / whole) : "-";
}

/// Whether any level has the figure: a hand that never rests has no "hold".
bool is_present(const MeshComparison& c, std::size_t figure) {
  for (const MeshVariable& v : c.variables)
    for (const MeshLevel& level : v.levels)
      if (figure < level.values.size() && std::isfinite(level.values[figure].value)) return true;
  return false;
}

void print_levels(const MeshComparison& c) {
  Rows rows;
  for (const MeshVariable& v : c.variables)
    for (const MeshLevel& level : v.levels) {
      if (level.status == compare::Status::kMissing) continue;  // not computed: the comparison was stopped
      std::vector<std::string> row = {v.name, divisions_text(level.divisions)};
      const bool ran = level.status == compare::Status::kOk;
      for (const long n : {level.elements, level.surface_vertices, level.most_samples})
        row.push_back(ran ? std::to_string(n) : "-");
      for (std::size_t q = 0; q < c.figures.size(); ++q)
        if (is_present(c, q)) row.push_back(ran ? figure_text(level.values[q].value) : "-");
      const double peak = ran ? level.values[0].value : 0.0;
      row.push_back(ran ? percent_of(level.from_finest, peak) : "-");
      row.push_back(ran ? percent_of(level.values[0].time_error, peak) : "-");
      if (c.tool) row.push_back(ran ? fmt::format("{:.4g}", 1e3 * v.step_s) : "-");
      row.push_back(ran ? fmt::format("{:.3g}", level.cpu_s) : "-");
      row.push_back(short_reason(level.reason));
      rows.push_back(std::move(row));
    }
  if (rows.empty()) return;
  std::vector<std::string> headers = {"resolution", "size", "elements", "surface vertices",
                                      "contact samples"};
  for (std::size_t q = 0; q < c.figures.size(); ++q)
    if (is_present(c, q)) headers.push_back(fmt::format("{} [{}]", c.figures[q], c.unit()));
  headers.insert(headers.end(), {"from finest, RMS [% of peak]", "time error of peak [%]"});
  if (c.tool) headers.emplace_back("steps [ms]");
  headers.insert(headers.end(), {"CPU [s]", ""});
  fmt::print("{}\n", report::format_table(headers, rows));
}

void print_errors(const MeshComparison& c) {
  Rows rows;
  for (const MeshVariable& v : c.variables)
    for (std::size_t q = 0; q < v.errors.size(); ++q) {
      const compare::MeshError& e = v.errors[q];
      if (!std::isfinite(e.limit.value)) continue;
      const double own = e.error + e.limit.value;
      rows.push_back({v.name, c.figures[q], std::isfinite(e.limit.order) ? figure_text(e.limit.order) : "-",
                      figure_text(e.limit.value), percent_of(e.limit.uncertainty, own),
                      percent_of(e.error, own),
                      std::isfinite(e.time_share) ? fmt::format("{:.2g}", e.time_share) : "-",
                      compare::to_string(e.limit.kind) + (e.is_resolved() ? "" : "; steps too long")});
    }
  if (rows.empty()) return;
  fmt::print("{}\n",
             report::format_table({"resolution", "figure", "order", fmt::format("estimate [{}]", c.unit()),
                                   "+- [%]", "error of the scene [%]", "time error / difference", ""},
                                  rows));
}

store::Summary mesh_summary(const CompareArguments& a, const scene::Description& d, const MeshComparison& c) {
  store::Summary summary;
  summary.command = "palpate compare --mesh " + a.scenes.front();
  for (const std::string& change : a.overrides) summary.command += " --set " + change;
  if (a.duration_s > 0.0) summary.command += fmt::format(" --duration-s {}", a.duration_s);
  summary.scene = d.name;
  summary.scene_source = d.source;
  summary.overrides = a.overrides;
  summary.outcome = c.stopped ? "interrupted" : "finished";
  summary.provenance = store::provenance();
  compare::add_to_summary(summary, c);
  return summary;
}

void add_missing(const MeshComparison& c, MissingOutputs& missing) {
  for (const MeshVariable& v : c.variables)
    for (const MeshLevel& level : v.levels)
      if (level.status != compare::Status::kOk && level.status != compare::Status::kMissing)
        missing.add(fmt::format("level {} of the {} of {}", divisions_text(level.divisions), v.name, c.scene),
                    level.reason);
}

void print_comparison(const MeshComparison& c) {
  for (const std::string& line : compare::in_words(c)) fmt::print("{}: {}\n", c.scene, line);
  fmt::print("\n");
  print_levels(c);
  print_errors(c);
  fmt::print("All levels by {}. {}\n", c.made_by, c.rules);
}

}  // namespace

void print_mesh_error(const std::string& scene_name, const std::string& folder) {
  const scene::Description scene = scene_of(SceneArguments{scene_name, {}, ""});
  const MeshComparison comparison = compare::mesh_error(scene, folder, make_model_at, {});
  for (const std::string& line : compare::in_words(comparison))
    fmt::print("{}: {}\n", comparison.scene, line);
  for (const MeshVariable& v : comparison.variables)
    for (const MeshLevel& level : v.levels)
      if (level.status != compare::Status::kOk)
        fmt::print("{}: the level {} of the {} failed: {}\n", comparison.scene,
                   divisions_text(level.divisions), v.name, short_reason(level.reason));
}

int compare_mesh(const CompareArguments& arguments) {
  const scene::Description scene = one_scene_of(arguments, "--mesh");
  const std::string folder =
      arguments.folder.empty() ? default_folder("compare-mesh-" + short_name(scene)) : arguments.folder;
  TaskFolder tasks(arguments.array, use_of(arguments, folder));
  experiments::EngineOutcome outcome;
  const MeshComparison comparison = compare_levels_watched(scene, arguments, folder, tasks.place(), outcome);
  compare::write(comparison, folder);
  const store::Summary summary = mesh_summary(arguments, scene, comparison);
  store::write_summary((fs::path(folder) / "summary.json").string(), summary);
  MissingOutputs missing;
  const report::RunReport written = report::write_run_report(folder);
  report::add_missing(written, missing);
  if (arguments.json) {
    fmt::print("{}\n", store::to_json(summary));
  } else {
    TaskFolder::print_reused(static_cast<std::size_t>(comparison.reused));
    print_comparison(comparison);
    fmt::print("written: {}\n", written.page.string());
  }
  if (comparison.stopped) {
    fmt::print(stderr, "palpate: stopped; the same command resumes from {}\n", folder);
    return missing.close(kExitStopped);
  }
  add_missing(comparison, missing);
  return missing.close(0);
}

}  // namespace palpate::cli
