#pragma once
#include <limits>
#include <string>
#include <vector>

#include "report/table.h"

namespace palpate::report {

/// Slope and intercept of the line through (log x, log y) by least squares; points that are not finite and
/// positive are left out.
struct LogLine {
  double slope = std::numeric_limits<double>::quiet_NaN(), intercept = 0.0;
  int points = 0;
};
/// The column that marks errors of `error_column` that the reference cannot tell: each error has its own
/// reference, a position below it says nothing about the force.
std::string below_column(const Table& table, const std::string& error_column);

LogLine fit_log_line(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace palpate::report
