#pragma once
#include <vector>

#include "product/contact.h"

namespace palpate::bench {

/// The least value that `share` of the values do not exceed; 0 where there are none.
double quantile(std::vector<double> values, double share);
inline double median(const std::vector<double>& values) { return quantile(values, 0.5); }
Spread spread_of(const std::vector<double>& values);

}  // namespace palpate::bench
