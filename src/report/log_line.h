#pragma once
#include <limits>
#include <vector>

namespace palpate::report {

/// Slope and intercept of the line through (log x, log y) by least squares; points that are not finite and
/// positive are left out.
struct LogLine {
  double slope = std::numeric_limits<double>::quiet_NaN(), intercept = 0.0;
  int points = 0;
};
LogLine fit_log_line(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace palpate::report
