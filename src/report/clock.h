#pragma once
#include <string>
#include <vector>

#include "report/plot.h"

namespace palpate::report {

/// How many values lie in each of the bins between `edges`, which are one more: ten bins a decade.
struct LogHistogram {
  std::vector<double> edges;
  std::vector<long> counts;
};

inline constexpr double kLeastBin = 0.1;  ///< lower edge of the first bin: what is less is counted there

/// @pre values not empty
LogHistogram log_histogram(const std::vector<double>& values);

/// Histogram of durations of ticks [us], both axes logarithmic, with lines at their p50, p99, p99.9 (nearest
/// rank) and maximum, whose values stand in the key.  A bin that is empty reaches half a tick.
/// @pre values_us not empty, finite  @param x_label  without unit
Plot tick_histogram(const std::vector<double>& values_us, const std::string& x_label);

}  // namespace palpate::report
