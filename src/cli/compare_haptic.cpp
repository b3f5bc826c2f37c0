#include "experiments/compare/haptic.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "cli/missing_outputs.h"
#include "cli/paths.h"
#include "cli/progress.h"
#include "cli/scene_of.h"
#include "cli/stop.h"
#include "compare.h"
#include "compare_tables.h"
#include "experiments/compare/summary.h"
#include "palpate/core/error.h"
#include "report/run_report.h"
#include "report/table.h"
#include "store/summary.h"

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;
using compare::HapticComparison;
using compare::HapticPoint;

HapticComparison compare_watched(const scene::Description& scene, const CompareArguments& a,
                                 const experiments::Place& place, experiments::EngineOutcome& outcome) {
  Progress progress("references");
  compare::CompareOptions options;
  options.repeats = a.repeats;
  options.limit_s = a.limit_s;
  options.reference_limit_s = a.reference_limit_s;
  options.jobs = a.jobs;
  options.integrators = a.integrators;
  options.progress = [&progress](double fraction, const std::string& what) { progress(fraction, what); };
  options.stop = &stop_flag();
  return compare::compare_haptic(scene, options, place, outcome);
}

std::string percent(double error, double peak) {
  const double share = compare::share_of_peak(error, peak);
  return std::isfinite(share) ? fmt::format("{:.3g}", 100.0 * share) : "-";
}

std::string outcome_of(const HapticPoint& p) {
  if (p.status == compare::Status::kOk) {
    if (p.force_unresolved || p.torque_unresolved)
      return fmt::format("{} not resolved by the reference",
                         p.force_unresolved ? p.torque_unresolved ? "force and torque" : "force" : "torque");
    return p.own ? "the scene's own" : "";
  }
  return short_reason(p.reason);
}

/// Whether the reference has a torque on the hand, or there is none to tell.
bool has_torque(const HapticComparison& c) { return !c.reference.available || c.peak_torque_n_m > 0.0; }

void print_points(const HapticComparison& c) {
  const bool torque = has_torque(c);
  std::vector<std::string> headers = {"variable",  "",           "force [N]", "% RMS",
                                      "% max",     "CPU [s]",    "query [s]", "linearise [s]",
                                      "ticks [s]", "bodies [s]", ""};
  if (torque) headers.insert(headers.begin() + 5, {"torque [N m]", "% RMS", "% max"});
  std::vector<std::vector<std::string>> rows;
  for (const HapticPoint& p : c.points) {
    if (p.status == compare::Status::kMissing) continue;  // not computed: the comparison was stopped
    const bool ran = p.status == compare::Status::kOk;
    const auto time = [ran](double s) { return ran ? fmt::format("{:.3f}", s) : std::string("-"); };
    rows.push_back({p.variable, p.value, report::short_number(p.error.force_rms_n),
                    percent(p.error.force_rms_n, c.peak_force_n),
                    percent(p.error.force_max_n, c.peak_force_n), time(p.cpu_median_s),
                    time(p.result.query_s), time(p.result.linearise_s), time(p.result.tool_s),
                    time(p.bodies_s()), outcome_of(p)});
    if (torque)
      rows.back().insert(rows.back().begin() + 5, {report::short_number(p.error.torque_rms_n_m),
                                                   percent(p.error.torque_rms_n_m, c.peak_torque_n_m),
                                                   percent(p.error.torque_max_n_m, c.peak_torque_n_m)});
  }
  fmt::print("{}\n", report::format_table(headers, rows));
}

void print_reference(const HapticComparison& c) {
  const compare::Reference& r = c.reference;
  fmt::print("{}: reference {}; {:.3g} s of CPU\n", c.scene, r.description, r.cpu_s);
  fmt::print("{}: peak force {:.4g} N, reference error {} N ({} %)\n", c.scene, c.peak_force_n,
             report::short_number(r.own_error.force_rms_n), percent(r.own_error.force_rms_n, c.peak_force_n));
  if (c.peak_torque_n_m > 0.0)
    fmt::print("{}: peak torque {:.4g} N m, reference error {} N m ({} %)\n", c.scene, c.peak_torque_n_m,
               report::short_number(r.own_error.torque_rms_n_m),
               percent(r.own_error.torque_rms_n_m, c.peak_torque_n_m));
  else if (r.available)
    fmt::print("{}: no torque on the hand\n", c.scene);
  if (!r.trouble.empty()) fmt::print("{}: {}\n", c.scene, r.trouble);
  fmt::print("\n");
}

std::string order_text(double order, int points) {
  return std::isfinite(order) ? fmt::format("{:.2f} ({} points)", order, points)
                              : fmt::format("none ({} usable points)", points);
}

void print_orders(const HapticComparison& c) {
  for (const compare::HapticOrder& order : c.orders)
    fmt::print("observed order by {}: force {}{}\n", order.variable,
               order_text(order.force, order.force_points),
               has_torque(c) ? ", torque " + order_text(order.torque, order.torque_points) : "");
  fmt::print("\n");
}

std::string command_of(const CompareArguments& a) {
  std::string out = "palpate compare --haptic " + a.scenes.front();
  for (const std::string& change : a.overrides) out += " --set " + change;
  for (const std::string& name : a.integrators) out += " --integrator " + name;
  if (a.duration_s > 0.0) out += fmt::format(" --duration-s {}", a.duration_s);
  return out;
}

void keep_summary(const CompareArguments& a, const scene::Description& d, const HapticComparison& c,
                  const std::string& folder) {
  store::Summary summary;
  summary.command = command_of(a);
  summary.scene = d.name;
  summary.scene_source = d.source;
  summary.overrides = a.overrides;
  summary.outcome = c.stopped ? "interrupted" : "finished";
  summary.provenance = store::provenance();
  compare::add_to_summary(summary, d, c);
  store::write_summary((fs::path(folder) / "summary.json").string(), summary);
}

/// Adds the missing outputs of a finished comparison.
void add_missing(const HapticComparison& c, MissingOutputs& missing) {
  if (!c.reference.trouble.empty()) missing.add("checked reference of " + c.scene, c.reference.trouble);
}

}  // namespace

int compare_haptic(const CompareArguments& arguments) {
  const scene::Description scene = one_scene_of(arguments, "--haptic");
  const std::string folder =
      arguments.folder.empty() ? default_folder("compare-haptic-" + short_name(scene)) : arguments.folder;
  TaskFolder tasks(arguments.array, use_of(arguments, folder));
  experiments::EngineOutcome outcome;
  const HapticComparison comparison = compare_watched(scene, arguments, tasks.place(), outcome);
  if (tasks.ends_early()) return tasks.end(outcome);
  compare::write(comparison, folder);
  keep_summary(arguments, scene, comparison, folder);
  TaskFolder::print_reused(outcome.reused);
  print_reference(comparison);
  print_points(comparison);
  print_orders(comparison);
  fmt::print("{}\n", comparison.rules);
  const report::RunReport written = report::write_run_report(folder);
  fmt::print("written: {}\n", written.page.string());
  if (comparison.stopped) {
    fmt::print(stderr, "palpate: stopped; the same command resumes from {}\n", folder);
    return kExitStopped;
  }
  MissingOutputs missing;
  tasks.add_missing(outcome, missing);
  report::add_missing(written, missing);
  add_missing(comparison, missing);
  return missing.close(0);
}

}  // namespace palpate::cli
