#pragma once
#include <vector>

#include "product/contact.h"

namespace palpate::bench {

/// Returns the least value that a fraction `share` of the values do not exceed; 0 if there are none.
double quantile(std::vector<double> values, double share);
inline double median(const std::vector<double>& values) { return quantile(values, 0.5); }
Spread spread_of(const std::vector<double>& values);

}  // namespace palpate::bench
