#pragma once
#include <string>
#include <vector>

#include "report/plot.h"

namespace palpate::report {

/// Histogram with ten bins per decade; `edges` has one more entry than `counts`.
struct LogHistogram {
  std::vector<double> edges;
  std::vector<long> counts;
};

inline constexpr double kLeastBin = 0.1;  ///< Lower edge of the first bin; smaller values are counted in it

/// Returns the histogram of the values.  @pre values not empty
LogHistogram log_histogram(const std::vector<double>& values);

/// Plots a histogram of durations of ticks [us], both axes logarithmic, with lines at p50, p99, p99.9
/// (nearest rank) and the maximum, whose values are in the key. An empty bin has the height of half a tick.
/// @pre values_us not empty, finite
/// @param x_label  label of the x axis, without unit
Plot tick_histogram(const std::vector<double>& values_us, const std::string& x_label);

}  // namespace palpate::report
