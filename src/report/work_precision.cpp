#include "palpate/report/work_precision.h"

#include <algorithm>
#include <cmath>

#include "log_line.h"
#include "palpate/core/error.h"

namespace palpate::report {
namespace {

/// Each error has its own reference: a position below it says nothing about the force.
std::string below_column(const Table& compare, const std::string& error_column) {
  const std::string own = error_column.substr(0, error_column.find('_')) + "_unresolved";
  return compare.has(own) ? own : "unresolved";
}

bool is_yes(const std::string& cell) { return cell == "yes" || cell == "true" || cell == "1"; }

}  // namespace

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

const std::vector<std::string>& exchange_columns() {
  static const std::vector<std::string> columns = {"exchange_period_s", "position_error_rel_l2",
                                                   "force_error_rms_n", "torque_error_rms_n_m", "cpu_s"};
  return columns;
}

std::string setting_text(const std::string& setting_name, double setting) {
  if (setting_name == "step_s" || setting_name == "tick_s")
    return setting < 1e-3 ? fmt::format("{:.3g} us", setting * 1e6) : fmt::format("{:.3g} ms", setting * 1e3);
  // 1e-04 as people write it: 1e-4.
  std::string text = fmt::format("{:.0e}", setting);
  if (to_number(text) != setting) text = fmt::format("{:.3g}", setting);
  if (const auto e = text.find("e-0"); e != std::string::npos) text.erase(e + 2, 1);
  return setting_name == "rtol" ? text : setting_name + " " + text;
}

Table rows_where(const Table& table, const std::string& column, const std::string& value) {
  if (!table.has(column)) return table;
  Table out{table.headers, {}, table.source};
  const std::size_t c = table.column(column);
  std::copy_if(table.rows.begin(), table.rows.end(), std::back_inserter(out.rows),
               [&](const auto& row) { return row[c] == value; });
  return out;
}

std::vector<std::string> distinct(const Table& table, const std::string& column) {
  std::vector<std::string> out;
  const std::size_t c = table.column(column);
  for (const auto& row : table.rows)
    if (std::find(out.begin(), out.end(), row[c]) == out.end()) out.push_back(row[c]);
  return out;
}

std::vector<Ladder> ladders(const Table& compare, const std::string& error_column,
                            const std::string& cost_column) {
  const std::vector<double> setting = compare.numbers("setting"), error = compare.numbers(error_column),
                            cost = compare.numbers(cost_column), order = compare.numbers("order");
  const auto text = [&](std::size_t row, const char* column) {
    return compare.rows[row][compare.column(column)];
  };
  const std::size_t below = compare.column(below_column(compare, error_column));
  std::vector<Ladder> out;
  for (std::size_t i = 0; i < compare.rows.size(); ++i) {
    const std::string label = text(i, "label");
    auto ladder = std::find_if(out.begin(), out.end(), [&](const Ladder& l) { return l.label == label; });
    if (ladder == out.end()) {
      out.push_back({label,
                     text(i, "integrator"),
                     text(i, "family"),
                     text(i, "stability"),
                     text(i, "setting_name"),
                     0,
                     {}});
      ladder = out.end() - 1;
      ladder->order = std::isfinite(order[i]) ? static_cast<int>(order[i]) : 0;
    }
    if (text(i, "status") == "ok" && std::isfinite(error[i])) {
      ladder->points.push_back({setting[i], error[i], cost[i], is_yes(compare.rows[i][below])});
    } else if (text(i, "status") != "ok") {
      ladder->failures.emplace_back(text(i, "status"), text(i, "reason"));
      ladder->failed_settings.push_back(setting[i]);
    }
  }
  return out;
}

std::vector<FittedOrder> fitted_orders(const Table& compare, const std::string& error_column) {
  std::vector<FittedOrder> orders;
  for (const Ladder& ladder : ladders(compare, error_column, "setting")) {
    std::vector<double> setting, error;
    for (const LadderPoint& p : ladder.points) {
      if (p.unresolved || p.error >= 1.0) continue;  // an error as large as the motion has no slope
      setting.push_back(p.setting);
      error.push_back(p.error);
    }
    const LogLine line = fit_log_line(setting, error);
    orders.push_back({ladder.label, ladder.integrator, ladder.setting_name, line.slope, line.points});
  }
  return orders;
}

Cost cost_at(const Ladder& ladder, double target, double reference_error) {
  const auto known = [&](const LadderPoint& p) {
    return std::isfinite(reference_error) ? std::max(p.error, reference_error) : p.error;
  };
  Cost best;
  const auto offer = [&](double value, bool at_most) {
    if (value >= 0.0 && !(value >= best.value)) best = {value, at_most};
  };
  for (std::size_t i = 0; i < ladder.points.size(); ++i) {
    const LadderPoint& fine = ladder.points[i];
    if (!(known(fine) <= target)) continue;
    if (i == 0) {
      offer(fine.cost, known(fine) < target);
      continue;
    }
    const LadderPoint& coarse = ladder.points[i - 1];
    if (!(known(coarse) > target)) {
      offer(fine.cost, true);  // an odd ladder, where a finer rung is cheaper
      continue;
    }
    const double share = std::log(known(coarse) / target) / std::log(known(coarse) / known(fine));
    const bool positive = coarse.cost > 0.0 && fine.cost > 0.0;
    offer(
        positive ? std::exp((1.0 - share) * std::log(coarse.cost) + share * std::log(fine.cost)) : fine.cost,
        false);
  }
  return best;
}

std::string cost_text(const Cost& cost) { return (cost.at_most ? "<= " : "") + short_number(cost.value); }

std::vector<Winner> winners(const Table& compare, const std::string& error_column,
                            const std::string& cost_column, const std::vector<double>& targets,
                            double reference_error) {
  const std::vector<Ladder> all = ladders(compare, error_column, cost_column);
  std::vector<Winner> out;
  for (const double target : targets) {
    Winner win;
    win.target = target;
    double second = kUnknown, baseline = kUnknown;
    for (const Ladder& ladder : all) {
      const Cost cost = cost_at(ladder, target, reference_error);
      if (std::isnan(cost.value)) continue;
      if (ladder.integrator == kBaseline && !(cost.value >= baseline)) baseline = cost.value;
      if (!win.found || cost.value < win.cost.value) {
        if (win.found) second = win.cost.value, win.runner_up = win.label;
        win.found = true;
        win.label = ladder.label;
        win.cost = cost;
      } else if (!(cost.value >= second)) {
        second = cost.value;
        win.runner_up = ladder.label;
      }
    }
    if (win.found && win.cost.value > 0.0) {
      win.runner_up_ratio = second / win.cost.value;
      win.baseline_ratio = baseline / win.cost.value;
    }
    out.push_back(win);
  }
  return out;
}

}  // namespace palpate::report
