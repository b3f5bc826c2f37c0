#pragma once
#include <string>
#include <vector>

namespace palpate::report {

/// Range of an axis, and its ticks if gnuplot would choose too few (one or two on a logarithmic axis of two
/// decades).
struct Axis {
  double low = 0.0, high = 1.0;
  bool logarithmic = false;
  std::vector<std::pair<double, std::string>> ticks = {};  ///< Positions and labels; empty: gnuplot chooses
};

/// Returns an axis over `values` (not empty; all positive if logarithmic), widened at either end by a
/// fraction of the range.
Axis make_axis(const std::vector<double>& values, bool logarithmic, double margin_low, double margin_high);

/// Returns the gnuplot commands that set the axis; `name` is "x" or "y".
std::string axis_commands(const std::string& name, const Axis& axis);

}  // namespace palpate::report
