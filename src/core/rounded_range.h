#pragma once
#include <cmath>

namespace palpate {

/// Returns the least number not below `x` > 0 that is 1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6 or 8 times a power of
/// ten; other x unchanged. Ranges that end there are equal in pictures of nearly the same values.
inline double rounded_range(double x) {
  if (!(x > 0.0) || !std::isfinite(x)) return x;
  const double decade = std::pow(10.0, std::floor(std::log10(x)));
  for (const double m : {1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (x <= m * decade * (1.0 + 1e-12)) return m * decade;
  return 10.0 * decade;
}

}  // namespace palpate
