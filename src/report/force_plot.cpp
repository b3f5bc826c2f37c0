#include "report/force_plot.h"

#include <cmath>

#include "palpate/core/error.h"

namespace palpate::report {
namespace {

/// Plots three components with columns PREFIX_x_UNIT ... and their magnitude, over time_s.
Plot vector_plot(const Table& table, const std::string& prefix, const std::string& unit,
                 const std::string& y_label, double limit, const std::string& unit_text) {
  const std::vector<double> time = table.numbers("time_s");
  Plot plot;
  plot.x_label = "time [s]";
  plot.y_label = y_label;
  std::vector<double> square(time.size(), 0.0);
  for (const char* axis : {"x", "y", "z"}) {
    const std::vector<double> component = table.numbers(fmt::format("{}_{}_{}", prefix, axis, unit));
    for (std::size_t i = 0; i < square.size(); ++i) square[i] += component[i] * component[i];
    plot.series.push_back({.name = axis, .x = time, .y = component});
  }
  for (double& s : square) s = std::sqrt(s);
  plot.series.push_back({.name = "magnitude", .x = time, .y = std::move(square), .colour = "ink"});
  if (limit > 0.0) plot.levels.push_back({limit, fmt::format("device limit {:g} {}", limit, unit_text)});
  return plot;
}

}  // namespace

Plot force_plot(const Table& force, double limit_n) {
  return vector_plot(force, "force", "n", "force on the hand [N]", limit_n, "N");
}

Plot torque_plot(const Table& force, double limit_n_m) {
  return vector_plot(force, "torque", "n_m", "torque on the hand [N m]", limit_n_m, "N m");
}

}  // namespace palpate::report
