#pragma once
#include <string>
#include <vector>

namespace palpate::report {

/// Range of an axis, and its ticks where gnuplot's own would be too few (a logarithmic axis of two decades
/// has one or two).
struct Axis {
  double low = 0.0, high = 1.0;
  bool logarithmic = false;
  std::vector<std::pair<double, std::string>> ticks = {};  ///< empty: gnuplot chooses
};

/// The range over `values` (not empty; all positive when logarithmic), widened by fractions of itself at
/// either end.
Axis make_axis(const std::vector<double>& values, bool logarithmic, double margin_low, double margin_high);

/// gnuplot commands that set it; `name` is "x" or "y".
std::string axis_commands(const std::string& name, const Axis& axis);

}  // namespace palpate::report
