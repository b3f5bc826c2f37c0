#include "palpate/report/work_precision.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate::report {
namespace {

/// A ladder point, as the fits and the plots use it.
struct Point {
  std::string integrator, setting_name;
  double setting = 0.0, error = 0.0, cpu_s = 0.0;
  bool below_reference = false, ok = true;
};

/// Each error has its own reference: a position below it says nothing about the force.
std::string below_column(const Table& compare, const std::string& error_column) {
  const std::string own = error_column.substr(0, error_column.find('_')) + "_below_reference";
  return compare.has(own) ? own : "below_reference";
}

std::vector<Point> points_of(const Table& compare, const std::string& error_column) {
  const std::vector<double> setting = compare.numbers("setting"), error = compare.numbers(error_column), cpu = compare.numbers("cpu_s_median");
  const std::size_t integrator = compare.column("integrator"), name = compare.column("setting_name"), status = compare.column("status"),
                    below = compare.column(below_column(compare, error_column));
  std::vector<Point> points;
  for (std::size_t i = 0; i < compare.rows.size(); ++i) {
    const auto& row = compare.rows[i];
    points.push_back({row[integrator], row[name], setting[i], error[i], cpu[i], row[below] == "true" || row[below] == "1" || row[below] == "yes",
                      row[status] == "ok"});
  }
  return points;
}

/// Integrators in the order of their first line.
std::vector<std::string> integrators_of(const std::vector<Point>& points) {
  std::vector<std::string> names;
  for (const Point& p : points)
    if (std::find(names.begin(), names.end(), p.integrator) == names.end()) names.push_back(p.integrator);
  return names;
}

/// Slope and intercept of the line through (log x, log y) by least squares.
struct LogLine {
  double slope = std::numeric_limits<double>::quiet_NaN(), intercept = 0.0;
  int points = 0;
};
LogLine fit_log_line(const std::vector<double>& x, const std::vector<double>& y) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0.0 && y[i] > 0.0 && std::isfinite(x[i]) && std::isfinite(y[i]))) continue;
    const double u = std::log(x[i]), v = std::log(y[i]);
    n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  LogLine line;
  line.points = static_cast<int>(n);
  const double determinant = n * sxx - sx * sx;
  if (n < 2 || !(determinant > 1e-12 * n * sxx)) return line;
  line.slope = (n * sxy - sx * sy) / determinant;
  line.intercept = (sy - line.slope * sx) / n;
  return line;
}

}  // namespace

const std::vector<std::string>& compare_columns() {
  static const std::vector<std::string> columns = {
      "scene", "integrator", "setting_name", "setting", "position_error_rel_l2", "position_error_max_m", "force_error_rms_n", "force_error_max_n",
      "torque_error_rms_n_m", "torque_error_max_n_m", "energy_error_j", "cpu_s_median", "cpu_s_min", "cpu_s_max", "force_evaluations",
      "tangent_evaluations", "factorisations", "linear_solves", "contact_queries", "steps", "status", "below_reference",
      "force_below_reference", "torque_below_reference"};
  return columns;
}

const std::vector<std::string>& exchange_columns() {
  static const std::vector<std::string> columns = {"exchange_period_s", "position_error_rel_l2", "force_error_rms_n", "torque_error_rms_n_m", "cpu_s"};
  return columns;
}

std::string setting_text(const std::string& setting_name, double setting) {
  if (setting_name == "step_s") return setting < 1e-3 ? fmt::format("{:.3g} us", setting * 1e6) : fmt::format("{:.3g} ms", setting * 1e3);
  // 1e-04 as people write it: 1e-4.
  std::string text = fmt::format("{:.0e}", setting);
  if (to_number(text) != setting) text = fmt::format("{:.3g}", setting);
  if (const auto e = text.find("e-0"); e != std::string::npos) text.erase(e + 2, 1);
  return setting_name == "rtol" ? text : setting_name + " " + text;
}

std::vector<FittedOrder> fitted_orders(const Table& compare, const std::string& error_column) {
  const std::vector<Point> points = points_of(compare, error_column);
  std::vector<FittedOrder> orders;
  for (const std::string& name : integrators_of(points)) {
    FittedOrder fitted;
    fitted.integrator = name;
    std::vector<double> setting, error;
    for (const Point& p : points) {
      if (p.integrator != name) continue;
      fitted.setting_name = p.setting_name;
      if (!p.ok || p.below_reference) continue;
      setting.push_back(p.setting);
      error.push_back(p.error);
    }
    const LogLine line = fit_log_line(setting, error);
    fitted.order = line.slope;
    fitted.points = line.points;
    orders.push_back(fitted);
  }
  return orders;
}

std::vector<Cheapest> cheapest(const Table& compare, const std::string& error_column, const std::vector<double>& targets) {
  std::vector<Cheapest> out;
  for (const double target : targets) {
    Cheapest best;
    best.target = target;
    for (const Point& p : points_of(compare, error_column)) {
      if (!p.ok || !(p.error <= target) || !(p.cpu_s >= 0.0) || (best.found && p.cpu_s >= best.cpu_s)) continue;
      best = {target, true, p.integrator, p.setting_name, p.setting, p.error, p.cpu_s};
    }
    out.push_back(best);
  }
  return out;
}

Plot work_precision_plot(const Table& compare, const std::string& error_column, const std::string& error_label, double reference_error) {
  const std::vector<Point> points = points_of(compare, error_column);
  Plot plot;
  plot.x_label = "CPU time [s]";
  plot.y_label = error_label;
  plot.log_x = plot.log_y = true;
  plot.floor_y = reference_error;
  plot.floor_label = "the reference's own error";
  for (const std::string& name : integrators_of(points)) {
    Series series{.name = name, .x = {}, .y = {}, .mark = Mark::kLinePoints};
    for (const Point& p : points) {
      if (p.integrator != name || !p.ok) continue;
      series.x.push_back(p.cpu_s);
      series.y.push_back(p.error);
      series.labels.push_back(setting_text(p.setting_name, p.setting));
      series.hollow.push_back(p.below_reference);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

Plot exchange_plot(const Table& exchange, const std::string& error_column, const std::string& error_label) {
  const std::vector<double> period = exchange.numbers("exchange_period_s"), error = exchange.numbers(error_column);
  Plot plot;
  plot.x_label = "exchange period [s]";
  plot.y_label = error_label;
  plot.log_x = plot.log_y = true;
  plot.height = 340;
  plot.series.push_back({.name = "measured", .x = period, .y = error, .mark = Mark::kLinePoints});
  const LogLine line = fit_log_line(period, error);
  if (std::isfinite(line.slope)) {
    const auto [least, greatest] = std::minmax_element(period.begin(), period.end());
    Series fit{.name = fmt::format("fitted order {:.2f}", line.slope), .x = {*least, *greatest}, .y = {}, .mark = Mark::kDashed, .colour = "ink"};
    for (const double x : fit.x) fit.y.push_back(std::exp(line.intercept + line.slope * std::log(x)));
    plot.series.push_back(std::move(fit));
  }
  return plot;
}

}  // namespace palpate::report
