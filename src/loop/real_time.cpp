#include "palpate/loop/real_time.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace palpate::loop {

double quantile(std::vector<float> values, double q) {
  if (values.empty()) return 0.0;
  const double rank = std::ceil(q * static_cast<double>(values.size())) - 1.0;
  const auto at = values.begin() +
                  std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(rank), 0, std::ssize(values) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace palpate::loop
