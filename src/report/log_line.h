#pragma once
#include <limits>
#include <string>
#include <vector>

#include "report/table.h"

namespace palpate::report {

/// Line through (log x, log y).
struct LogLine {
  double slope = std::numeric_limits<double>::quiet_NaN(), intercept = 0.0;
  int points = 0;  ///< Number of points fitted
};
/// Returns the column that marks the errors of `error_column` that the reference cannot resolve. Each error
/// quantity has its own reference error: an unresolved position error gives no information about the force
/// error.
std::string below_column(const Table& table, const std::string& error_column);

/// Fits a line by least squares; points that are not finite and positive are left out. The slope is NaN with
/// fewer than two points.
LogLine fit_log_line(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace palpate::report
