#include "report/work_precision.h"

#include <algorithm>
#include <cmath>

#include "log_line.h"
#include "palpate/core/error.h"

namespace palpate::report {
namespace {

/// Least and largest cost over the repeats of a point. A point that ran once takes the median spread of the
/// other points, NaN if no point was repeated; counts have no spread.
class Spread {
 public:
  Spread(const Table& compare, const std::string& cost_column) {
    if (cost_column != "cpu_s_median" || !compare.has("cpu_s_min") || !compare.has("cpu_s_max")) return;
    typical_ = kUnknown;
    least_ = compare.numbers("cpu_s_min");
    most_ = compare.numbers("cpu_s_max");
    repeats_ = compare.numbers("repeats");
    std::vector<double> ratios;
    for (std::size_t i = 0; i < least_.size(); ++i)
      if (repeats_[i] > 1.0 && least_[i] > 0.0) ratios.push_back(std::sqrt(most_[i] / least_[i]));
    if (ratios.empty()) return;
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    typical_ = *middle;
  }
  std::pair<double, double> of(std::size_t row, double cost) const {
    if (least_.empty() || !std::isfinite(cost)) return {cost, cost};
    if (repeats_[row] > 1.0) return {least_[row], most_[row]};
    return {cost / typical_, cost * typical_};
  }

 private:
  std::vector<double> least_, most_, repeats_;
  double typical_ = 1.0;
};

}  // namespace

std::string below_column(const Table& table, const std::string& error_column) {
  const std::string own = error_column.substr(0, error_column.find('_')) + "_unresolved";
  return table.has(own) ? own : "unresolved";
}

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

std::vector<double> targets_of(double scale) {
  std::vector<double> targets = kTargets;
  for (double& target : targets) target *= scale;
  return targets;
}

const std::vector<std::string>& exchange_columns() {
  static const std::vector<std::string> columns = {"exchange_period_s", "position_error_rel_l2",
                                                   "force_error_rms_n", "torque_error_rms_n_m", "cpu_s"};
  return columns;
}

std::string setting_text(const std::string& setting_name, double setting) {
  if (!std::isfinite(setting)) return short_number(setting);
  if (setting_name == "step_s" || setting_name == "tick_s")
    return setting < 1e-3 ? fmt::format("{:.3g} us", setting * 1e6) : fmt::format("{:.3g} ms", setting * 1e3);
  // 1e-4 instead of 1e-04
  std::string text = fmt::format("{:.0e}", setting);
  if (to_number(text) != setting) text = fmt::format("{:.3g}", setting);
  if (const auto e = text.find("e-0"); e != std::string::npos) text.erase(e + 2, 1);
  return setting_name == "rtol" ? text : setting_name + " " + text;
}

std::vector<Ladder> ladders(const Table& compare, const std::string& error_column,
                            const std::string& cost_column) {
  const std::vector<double> setting = compare.numbers("setting"), error = compare.numbers(error_column),
                            cost = compare.numbers(cost_column), order = compare.numbers("order");
  const std::size_t below = compare.column(below_column(compare, error_column));
  const Spread spread(compare, cost_column);
  std::vector<Ladder> out;
  for (std::size_t i = 0; i < compare.rows.size(); ++i) {
    const std::string label = compare.cell(i, "label");
    auto ladder = std::find_if(out.begin(), out.end(), [&](const Ladder& l) { return l.label == label; });
    if (ladder == out.end()) {
      out.push_back({label,
                     compare.cell(i, "integrator"),
                     compare.cell(i, "family"),
                     compare.cell(i, "stability"),
                     compare.cell(i, "setting_name"),
                     0,
                     false,
                     {}});
      ladder = out.end() - 1;
      ladder->order = std::isfinite(order[i]) ? static_cast<int>(order[i]) : 0;
      ladder->coarsest_tried = is_yes(compare.cell(i, "coarsest"));
    }
    if (compare.cell(i, "status") == "ok" && std::isfinite(error[i])) {
      const auto [low, high] = spread.of(i, cost[i]);
      LadderPoint point{setting[i], error[i], cost[i], low, high, is_yes(compare.rows[i][below])};
      const std::vector<double>& failed = ladder->failed_settings;
      const double before = ladder->points.empty() ? kUnknown : ladder->points.back().setting;
      point.behind_failure = !failed.empty() && !(failed.back() >= before);
      if (point.behind_failure) point.failed_before = failed.back();
      ladder->points.push_back(point);
    } else if (compare.cell(i, "status") != "ok") {
      ladder->failures.emplace_back(compare.cell(i, "status"), compare.cell(i, "reason"));
      ladder->failed_settings.push_back(setting[i]);
    }
  }
  return out;
}

std::vector<FittedOrder> fitted_orders(const Table& compare, const std::string& error_column, double scale) {
  std::vector<FittedOrder> orders;
  for (const Ladder& ladder : ladders(compare, error_column, "setting")) {
    std::vector<double> setting, error;
    for (const LadderPoint& p : ladder.points) {
      if (p.unresolved || p.error >= scale) continue;
      setting.push_back(p.setting);
      error.push_back(p.error);
    }
    const LogLine line = fit_log_line(setting, error);
    orders.push_back({ladder.label, ladder.integrator, ladder.setting_name, line.slope, line.points});
  }
  return orders;
}

}  // namespace palpate::report
