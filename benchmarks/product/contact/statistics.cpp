#include "product/contact/statistics.h"

#include <algorithm>
#include <cmath>

namespace palpate::bench {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size()))) - 1;
  return values[std::min(at, values.size() - 1)];
}

Spread spread_of(const std::vector<double>& values) {
  return {quantile(values, 1e-9), median(values), quantile(values, 0.99)};
}

}  // namespace palpate::bench
