#include "palpate/study/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "commands.h"
#include "palpate/core/error.h"
#include "palpate/report/run_report.h"
#include "palpate/report/table.h"
#include "palpate/report/work_precision.h"
#include "places.h"
#include "progress.h"
#include "scene_of.h"
#include "stop.h"

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;
using Rows = std::vector<std::vector<std::string>>;

/// Scenes with the command line's changes in their text: results are kept under that text.
std::vector<scene::Description> scenes_of(const CompareArguments& arguments) {
  std::vector<scene::Description> out;
  for (const std::string& name : arguments.scenes) {
    SceneArguments one{name, arguments.overrides, ""};
    if (arguments.duration_s > 0.0) one.overrides.push_back(fmt::format("compare.duration_s={}", arguments.duration_s));
    out.push_back(scene_of(one));
    const auto same = std::count_if(out.begin(), out.end(), [&](const scene::Description& d) { return d.name == out.back().name; });
    if (same > 1) fail("two scenes are called \"{}\"; give one of them another [scene] name", out.back().name);
  }
  return out;
}

std::string default_name(const std::vector<scene::Description>& scenes) {
  std::string out = "compare";
  for (const scene::Description& d : scenes) out.append("-").append(short_name(d));
  return out;
}

std::string outcome_text(const study::ComparePoint& p) {
  if (p.status != study::PointStatus::kOk) return p.reason.substr(0, p.reason.find('\n'));
  return p.below_reference ? "below the reference" : "";
}

void print_points(const study::SceneComparison& scene) {
  std::vector<std::string> headers = {"integrator", "setting", "position error", "CPU [s]", "steps", "force evals", "factors", ""};
  if (scene.tool) headers.insert(headers.begin() + 3, {"force error [N]", "torque error [N m]"});
  Rows rows;
  for (const study::ComparePoint& p : scene.points) {
    if (p.status == study::PointStatus::kMissing) continue;  // stopped before it
    const dynamics::StepperCounters& c = p.result.counters;
    const bool ran = p.status == study::PointStatus::kOk;
    const auto count = [&](long n) { return ran ? std::to_string(n) : std::string("-"); };
    rows.push_back({p.label, report::setting_text(p.setting_name, p.setting), report::short_number(p.error.position_rel_l2),
                    ran ? fmt::format("{:.3f}", p.cpu_median_s) : "-", count(c.steps), count(c.force_evaluations), count(c.solver.factorisations), outcome_text(p)});
    if (scene.tool)
      rows.back().insert(rows.back().begin() + 3, {report::short_number(p.error.force_rms_n), report::short_number(p.error.torque_rms_n_m)});
  }
  fmt::print("{}\n", report::format_table(headers, rows));
}

void print_fits(const report::Table& table) {
  Rows rows;
  for (const report::FittedOrder& fit : report::fitted_orders(table, "position_error_rel_l2"))
    rows.push_back({fit.label, fit.setting_name, fit.points < 2 ? "-" : fmt::format("{:.2f}", fit.order), std::to_string(fit.points)});
  fmt::print("{}\n", report::format_table({"integrator", "against", "fitted order", "points"}, rows));
  rows.clear();
  for (const report::Winner& win : report::winners(table, "position_error_rel_l2", "cpu_s_median", report::kTargets))
    rows.push_back({fmt::format("{:g}", win.target), win.found ? win.label : "none reaches it", win.found ? report::cost_text(win.cost) : "-",
                    win.runner_up.empty() ? "-" : fmt::format("{} ({:.2f} x)", win.runner_up, win.runner_up_ratio),
                    std::isfinite(win.baseline_ratio) ? fmt::format("{:.3g} x", win.baseline_ratio) : "-"});
  fmt::print("{}\n", report::format_table({"position error at most", "cheapest", "CPU [s]", "runner-up", "linearly-implicit-euler"}, rows));
}

void print_restarts(const study::SceneComparison& scene) {
  Rows rows;
  for (const study::ComparePoint& p : scene.restarts) {
    if (p.status == study::PointStatus::kMissing) continue;
    const dynamics::StepperCounters& c = p.result.counters;
    const bool ran = p.status == study::PointStatus::kOk;
    const auto rate = [&](long n) { return ran ? fmt::format("{:.0f}", static_cast<double>(n) / p.result.time) : std::string("-"); };
    rows.push_back({p.label, p.multistep ? "yes" : "no", fmt::format("{:g}", 1e3 * p.setting), ran ? std::to_string(c.reinits) : "-", rate(c.steps),
                    rate(c.force_evaluations), ran ? "" : p.reason});
  }
  if (rows.empty()) return;
  fmt::print("{}\n", report::format_table({"integrator", "multistep", "contact refresh [ms]", "restarts", "steps / s", "force evals / s", ""}, rows));
}

void print_exchange(const study::SceneComparison& scene) {
  if (scene.exchange.empty()) return;
  Rows rows;
  for (const study::ExchangePoint& p : scene.exchange)
    rows.push_back({fmt::format("{:g}", 1e3 * p.exchange_period_s), fmt::format("{:.2e}", p.error.position_rel_l2),
                    fmt::format("{:.2e}", p.error.force_rms_n), fmt::format("{:.2e}", p.error.torque_rms_n_m),
                    fmt::format("{:.3f}", p.cpu_s)});
  fmt::print("{}\n", report::format_table(
                         {"exchange period [ms]", "position error", "force error [N]", "torque error [N m]", "CPU [s]"}, rows));
}

void print_methods(const study::SceneComparison& scene) {
  if (scene.methods.empty()) return;
  Rows rows;
  for (const study::MethodPoint& p : scene.methods)
    rows.push_back({p.method, fmt::format("{:.2e}", p.difference.position_rel_l2),
                    fmt::format("{:.2e}", p.difference.force_rms_n), fmt::format("{:.4f}", p.peak_force_n),
                    std::to_string(p.most_samples), fmt::format("{:.3f}", p.query_s), fmt::format("{:.3f}", p.cpu_s)});
  fmt::print("{}\n", report::format_table({"contact found by", "position difference", "force difference [N]", "peak force [N]",
                                           "samples", "queries [s]", "CPU [s]"},
                                          rows));
}

void print_reference(const study::SceneComparison& scene) {
  const study::Reference& r = scene.reference;
  fmt::print("{}: reference {}; its own error: position {}{}\n", scene.scene, r.description,
             std::isfinite(r.own_error.position_rel_l2) ? fmt::format("{:.1e}", r.own_error.position_rel_l2) : "unknown",
             scene.tool && std::isfinite(r.own_error.force_rms_n)
                 ? fmt::format(", force {:.1e} N, torque {:.1e} N m", r.own_error.force_rms_n, r.own_error.torque_rms_n_m)
                 : "");
  if (!r.trouble.empty()) fmt::print("{}: {}\n", scene.scene, r.trouble);
  for (const std::string& note : scene.notes) fmt::print("{}: {}\n", scene.scene, note);
  fmt::print("\n");
}

study::Comparison compare_watched(const std::vector<scene::Description>& scenes, const CompareArguments& arguments, const std::string& folder) {
  Progress progress("reference runs");
  study::CompareOptions options;
  options.repeats = arguments.repeats;
  options.limit_s = arguments.limit_s;
  options.reference_limit_s = arguments.reference_limit_s;
  options.jobs = arguments.jobs;
  options.integrators = arguments.integrators;
  options.all = arguments.all;
  options.database = (fs::path(folder) / "study.sqlite").string();
  options.progress = [&progress](double fraction, const std::string& what) { progress(fraction, what); };
  options.stop = &stop_flag();
  if (arguments.fresh) fs::remove(options.database);
  return study::compare(scenes, options);
}

}  // namespace

int compare(const CompareArguments& arguments) {
  const std::vector<scene::Description> scenes = scenes_of(arguments);
  const std::string folder = arguments.folder.empty() ? default_folder(default_name(scenes)) : arguments.folder;
  make_folder(folder);

  const study::Comparison comparison = compare_watched(scenes, arguments, folder);
  study::write(comparison, folder);
  if (comparison.reused > 0) fmt::print("{} runs were done before, and were not done again (--fresh starts anew)\n\n", comparison.reused);
  const fs::path points = fs::path(folder) / "compare.csv";
  const report::Table table = fs::exists(points) ? report::read_csv(points) : report::Table{};
  for (const study::SceneComparison& scene : comparison.scenes) {
    print_reference(scene);
    const report::Table own = report::rows_where(table, "scene", scene.scene);
    if (own.rows.empty()) continue;
    print_points(scene);
    print_fits(own);
    print_restarts(scene);
    print_exchange(scene);
    print_methods(scene);
    fmt::print("{}\n\n", report::in_words(own, scene.reference.own_error.position_rel_l2));
  }
  fmt::print("{}\n", comparison.rules);
  if (!table.rows.empty()) fmt::print("written: {}\n", report::write_run_report(folder).string());
  if (!comparison.stopped) return 0;
  fmt::print(stderr, "palpate: stopped; the same command goes on from {}\n", folder);
  return kExitStopped;
}

}  // namespace palpate::cli
