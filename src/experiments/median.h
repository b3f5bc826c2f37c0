#pragma once
#include <algorithm>
#include <vector>

namespace palpate::experiments {

/// Returns the median.  @pre at least one value
inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

}  // namespace palpate::experiments
