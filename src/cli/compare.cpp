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

using Rows = std::vector<std::vector<std::string>>;

void check_integrators(const scene::Description& description, const std::vector<std::string>& wanted) {
  std::vector<std::string> known;
  for (const scene::LadderSpec& ladder : description.compare.ladders) known.push_back(ladder.integrator);
  for (const std::string& name : wanted)
    if (std::find(known.begin(), known.end(), name) == known.end())
      fail("{}: its [[compare.ladder]] tables do not name the integrator \"{}\"{}", description.path, name,
           suggestion(name, known));
}

void print_points(const study::Comparison& comparison, bool tool) {
  std::vector<std::string> headers = {"integrator", "setting",     "position error", "CPU [s]",
                                      "steps",      "force evals", "factors",        ""};
  if (tool) headers.insert(headers.begin() + 3, {"force error [N]", "torque error [N m]"});
  Rows rows;
  for (const study::ComparePoint& p : comparison.points) {
    if (p.cpu_s.empty()) continue;  // stopped before it
    const dynamics::StepperCounters& c = p.result.counters;
    rows.push_back({p.integrator, report::setting_text(p.setting_name, p.setting), fmt::format("{:.2e}", p.error.position_rel_l2),
                    fmt::format("{:.3f}", p.cpu_median_s), std::to_string(c.steps), std::to_string(c.force_evaluations),
                    std::to_string(c.solver.factorisations),
                    !p.result.status.ok() ? p.result.status.message
                    : p.below_reference   ? "below the reference"
                                          : ""});
    if (tool)
      rows.back().insert(rows.back().begin() + 3,
                         {fmt::format("{:.2e}", p.error.force_rms_n), fmt::format("{:.2e}", p.error.torque_rms_n_m)});
  }
  fmt::print("{}\n", report::format_table(headers, rows));
}

void print_fits(const report::Table& table) {
  Rows rows;
  for (const report::FittedOrder& fit : report::fitted_orders(table, "position_error_rel_l2"))
    rows.push_back(
        {fit.integrator, fit.setting_name, fit.points < 2 ? "-" : fmt::format("{:.2f}", fit.order), std::to_string(fit.points)});
  fmt::print("{}\n", report::format_table({"integrator", "against", "fitted order", "points"}, rows));
  rows.clear();
  for (const report::Cheapest& best : report::cheapest(table, "position_error_rel_l2", {1e-2, 1e-3, 1e-4}))
    rows.push_back({fmt::format("{:g}", best.target), best.found ? best.integrator : "none reaches it",
                    best.found ? report::setting_text(best.setting_name, best.setting) : "-",
                    best.found ? report::short_number(best.cpu_s) : "-"});
  fmt::print("{}\n", report::format_table({"position error at most", "cheapest", "setting", "CPU [s]"}, rows));
}

void print_exchange(const study::Comparison& comparison) {
  if (comparison.exchange.empty()) return;
  Rows rows;
  for (const study::ExchangePoint& p : comparison.exchange)
    rows.push_back({fmt::format("{:g}", 1e3 * p.exchange_period_s), fmt::format("{:.2e}", p.error.position_rel_l2),
                    fmt::format("{:.2e}", p.error.force_rms_n), fmt::format("{:.2e}", p.error.torque_rms_n_m),
                    fmt::format("{:.3f}", p.cpu_s)});
  fmt::print("{}\n", report::format_table(
                         {"exchange period [ms]", "position error", "force error [N]", "torque error [N m]", "CPU [s]"}, rows));
}

void print_methods(const study::Comparison& comparison) {
  if (comparison.methods.empty()) return;
  Rows rows;
  for (const study::MethodPoint& p : comparison.methods)
    rows.push_back({p.method, fmt::format("{:.2e}", p.difference.position_rel_l2),
                    fmt::format("{:.2e}", p.difference.force_rms_n), fmt::format("{:.4f}", p.peak_force_n),
                    std::to_string(p.most_samples), fmt::format("{:.3f}", p.query_s), fmt::format("{:.3f}", p.cpu_s)});
  fmt::print("{}\n", report::format_table({"contact found by", "position difference", "force difference [N]", "peak force [N]",
                                           "samples", "queries [s]", "CPU [s]"},
                                          rows));
}

study::Comparison compare_watched(const scene::Description& description, const CompareArguments& arguments) {
  Progress progress("reference run");
  study::CompareOptions options;
  options.repeats = arguments.repeats;
  options.integrators = arguments.integrators;
  options.progress = [&progress](double fraction, const std::string& what) { progress(fraction, what); };
  options.stop = &stop_flag();
  return study::compare(description, options);
}

}  // namespace

int compare(const CompareArguments& arguments) {
  scene::Description description = scene_of(arguments.scene);
  if (arguments.duration_s > 0.0) description.compare.duration_s = arguments.duration_s;
  check_integrators(description, arguments.integrators);
  const std::string folder = arguments.folder.empty() ? default_folder("compare-" + short_name(description)) : arguments.folder;
  make_folder(folder);

  const study::Comparison comparison = compare_watched(description, arguments);
  study::write(comparison, folder);
  fmt::print("{}: reference {}; its own error: position {:.1e}{}\n\n", short_name(description), comparison.reference.description,
             comparison.reference.own_error.position_rel_l2,
             description.tool ? fmt::format(", force {:.1e} N, torque {:.1e} N m", comparison.reference.own_error.force_rms_n,
                                            comparison.reference.own_error.torque_rms_n_m)
                              : "");
  print_points(comparison, description.tool.has_value());
  print_fits(report::read_csv(std::filesystem::path(folder) / "compare.csv"));
  print_exchange(comparison);
  print_methods(comparison);
  fmt::print("written: {}\n", report::write_run_report(folder).string());
  if (!comparison.stopped) return 0;
  fmt::print(stderr, "palpate: stopped; the points that were finished are in {}\n", folder);
  return kExitStopped;
}

}  // namespace palpate::cli
