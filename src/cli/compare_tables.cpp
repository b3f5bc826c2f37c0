#include "compare_tables.h"

#include <fmt/format.h>

#include <cmath>

#include "loop/describe_fallbacks.h"
#include "report/cost_envelope.h"
#include "report/work_precision.h"

namespace palpate::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// Most points printed on the terminal; more are left to compare.csv and the report.
constexpr std::size_t kPointsOnScreen = 80;

std::string outcome_text(const compare::ComparePoint& p) {
  if (p.status == compare::Status::kOk) {
    const std::string silent = loop::describe_fallbacks(p.result.counters);
    if (!p.unresolved) return silent;
    return "not resolved by the reference" + (silent.empty() ? "" : "; " + silent);
  }
  return short_reason(p.reason);
}

/// Whether the reference has a torque on the hand, or there is none to tell.
bool has_torque(const compare::SceneComparison& scene) {
  return scene.tool && (!scene.reference.available || scene.reference.peak_torque_n_m > 0.0);
}

/// Returns the end of a sequence of neighbouring levels with the same failure, which one line represents.
std::size_t end_of_failures(const std::vector<compare::ComparePoint>& points, std::size_t first) {
  std::size_t end = first + 1;
  while (points[first].status != compare::Status::kOk && end < points.size() &&
         points[end].label == points[first].label && points[end].status == points[first].status)
    ++end;
  return end;
}

}  // namespace

std::string short_reason(const std::string& reason) {
  constexpr std::size_t kMost = 90;  // characters
  const std::string line = reason.substr(0, reason.find('\n'));
  return line.size() <= kMost ? line : line.substr(0, line.find_last_of(' ', kMost)) + " ...";
}

void print_points(const compare::SceneComparison& scene) {
  std::vector<std::string> headers = {"integrator",    "setting", "error test",  "position error", "CPU [s]",
                                      "linear solver", "steps",   "force evals", "factors",        ""};
  const bool torque = has_torque(scene);
  if (torque) headers.insert(headers.begin() + 4, "torque error [N m]");
  if (scene.tool) headers.insert(headers.begin() + 4, "force error [N]");
  Rows rows;
  for (std::size_t i = 0; i < scene.points.size(); i = end_of_failures(scene.points, i)) {
    const compare::ComparePoint& p = scene.points[i];
    if (p.status == compare::Status::kMissing) continue;  // not computed: the comparison was stopped
    const dynamics::StepperCounters& c = p.result.counters;
    const bool ran = p.status == compare::Status::kOk;
    const auto count = [&](long n) { return ran ? std::to_string(n) : std::string("-"); };
    std::string setting = report::setting_text(p.setting_name, p.setting);
    if (const std::size_t end = end_of_failures(scene.points, i); end > i + 1)
      setting += " to " + report::setting_text(p.setting_name, scene.points[end - 1].setting);
    rows.push_back({p.label, setting, report::short_number(p.error_test_rtol),
                    report::short_number(p.error.position_rel_l2),
                    ran ? fmt::format("{:.3f}", p.cpu_median_s) : "-",
                    p.linear_solver.empty() ? "-" : p.linear_solver, count(c.steps),
                    count(c.force_evaluations), count(c.solver.factorisations), outcome_text(p)});
    if (torque) rows.back().insert(rows.back().begin() + 4, report::short_number(p.error.torque_rms_n_m));
    if (scene.tool) rows.back().insert(rows.back().begin() + 4, report::short_number(p.error.force_rms_n));
  }
  if (rows.size() <= kPointsOnScreen)
    fmt::print("{}\n", report::format_table(headers, rows));
  else
    fmt::print("{} points; compare.csv has one line per point.\n\n", scene.points.size());
}

void print_trials(const compare::SceneComparison& scene) {
  if (scene.trials.empty()) return;
  Rows rows;
  for (const compare::ComparePoint& p : scene.trials)
    rows.push_back({p.label, report::setting_text(p.setting_name, p.setting),
                    report::short_number(p.error.position_rel_l2),
                    p.status == compare::Status::kOk ? fmt::format("{:.3f}", p.cpu_median_s) : "-",
                    outcome_text(p)});
  fmt::print("{}\n",
             report::format_table({"linear solver tried", "at", "position error", "CPU [s]", ""}, rows));
}

void print_prices(const report::Table& table, double reference_error) {
  constexpr const char* kError = "position_error_rel_l2";
  std::vector<std::string> headers = {"integrator", "fitted order", "points", "best error"};
  for (const double target : report::kTargets) headers.push_back(fmt::format("CPU [s] at {:g}", target));
  const std::vector<report::FittedOrder> fits = report::fitted_orders(table, kError);
  Rows rows;
  for (const report::Ladder& ladder : report::ladders(table, kError, "cpu_s_median")) {
    std::string order = "-";
    for (const report::FittedOrder& fit : fits)
      if (fit.label == ladder.label && fit.points > 1)
        order = fmt::format("{:.2f} in {}", fit.order, fit.setting_name);
    double best = report::kUnknown;
    for (const report::LadderPoint& point : ladder.points)
      if (!point.unresolved) best = std::fmin(best, point.error);
    rows.push_back({ladder.label, order, std::to_string(ladder.points.size()), report::short_number(best)});
    for (const double target : report::kTargets)
      rows.back().push_back(report::cost_text(report::cost_at(ladder, target, reference_error)));
  }
  fmt::print("{}\n", report::format_table(headers, rows));
  rows.clear();
  for (const report::Winner& win :
       report::winners(table, kError, "cpu_s_median", report::kTargets, reference_error))
    rows.push_back(
        report::winner_row(win, win.target, win.declared() ? win.label : "no winner: " + win.label));
  fmt::print("{}\n", report::format_table({"position error at most", "cheapest", "CPU [s]", "range",
                                           "runner-up", "ratio", report::kBaseline},
                                          rows));
}

void print_restarts(const compare::SceneComparison& scene) {
  Rows rows;
  for (const compare::ComparePoint& p : scene.restarts) {
    if (p.status == compare::Status::kMissing) continue;
    const dynamics::StepperCounters& c = p.result.counters;
    const bool ran = p.status == compare::Status::kOk;
    const auto rate = [&](long n) {
      return ran ? fmt::format("{:.0f}", static_cast<double>(n) / p.result.time) : std::string("-");
    };
    rows.push_back({p.label, p.multistep ? "yes" : "no", fmt::format("{:g}", 1e3 * p.setting),
                    ran ? std::to_string(c.reinits) : "-", rate(c.steps), rate(c.force_evaluations),
                    ran ? "" : p.reason});
  }
  if (rows.empty()) return;
  fmt::print("{}\n", report::format_table({"integrator", "multistep", "contact refresh [ms]", "restarts",
                                           "steps / s", "force evals / s", ""},
                                          rows));
}

void print_exchange(const compare::SceneComparison& scene) {
  if (scene.exchange.points.empty()) return;
  const compare::ExchangeStudy& study = scene.exchange;
  fmt::print("monolithic solution by {}, checked by {}; reference error: position {}, force {} N\n",
             study.made_by, study.checked_by, report::short_number(study.own_error.position_rel_l2),
             report::short_number(study.own_error.force_rms_n));
  std::vector<std::string> headers = {"exchange period [ms]", "position error", "force error [N]", "CPU [s]",
                                      ""};
  const bool torque = has_torque(scene);
  if (torque) headers.insert(headers.begin() + 3, "torque error [N m]");
  Rows rows;
  for (const compare::ExchangePoint& p : study.points) {
    const std::string outcome = !p.trouble.empty()                   ? short_reason(p.trouble)
                                : p.unresolved || p.force_unresolved ? "not resolved by the reference"
                                                                     : "";
    rows.push_back({fmt::format("{:g}", 1e3 * p.exchange_period_s),
                    report::short_number(p.error.position_rel_l2), report::short_number(p.error.force_rms_n),
                    fmt::format("{:.3f}", p.cpu_s), outcome});
    if (torque) rows.back().insert(rows.back().begin() + 3, report::short_number(p.error.torque_rms_n_m));
  }
  fmt::print("{}\n", report::format_table(headers, rows));
}

void print_methods(const compare::SceneComparison& scene) {
  if (scene.methods.empty()) return;
  Rows rows;
  for (const compare::MethodPoint& p : scene.methods) {
    const bool ran = p.trouble.empty();
    const auto cell = [ran](const std::string& text) { return ran ? text : std::string("-"); };
    rows.push_back({p.method, cell(report::short_number(p.difference.position_rel_l2)),
                    cell(report::short_number(p.difference.force_rms_n)),
                    cell(report::short_number(p.peak_force_n, 4)), cell(std::to_string(p.most_samples)),
                    cell(fmt::format("{:.3f}", p.query_s)), cell(fmt::format("{:.3f}", p.cpu_s)),
                    short_reason(p.trouble)});
  }
  fmt::print("{}\n", report::format_table({"contact method", "position difference", "force difference [N]",
                                           "peak force [N]", "samples", "queries [s]", "CPU [s]", ""},
                                          rows));
}

void print_reference(const compare::SceneComparison& scene) {
  const compare::Reference& r = scene.reference;
  std::string force;
  if (scene.tool && std::isfinite(r.own_error.force_rms_n)) {
    force = fmt::format(", force {:.1e} N", r.own_error.force_rms_n);
    force += has_torque(scene) ? fmt::format(", torque {:.1e} N m", r.own_error.torque_rms_n_m)
                               : std::string("; no torque on the hand");
  }
  fmt::print("{}: reference {}; reference error: position {}{}\n", scene.scene, r.description,
             std::isfinite(r.own_error.position_rel_l2) ? fmt::format("{:.1e}", r.own_error.position_rel_l2)
                                                        : "unknown",
             force);
  if (!r.trouble.empty()) fmt::print("{}: {}\n", scene.scene, r.trouble);
  for (const compare::MissingChart& chart : scene.missing_charts)
    fmt::print("{}: {}\n", scene.scene, chart.text());
  fmt::print("\n");
}

}  // namespace palpate::cli
