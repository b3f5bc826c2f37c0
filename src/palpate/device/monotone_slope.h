#pragma once
#include "palpate/core/types.h"

namespace palpate::device {

/// Returns the slope nearest to `slope` with which Hermite's cubic over a segment of that mean slope stays
/// between the segment's ends, in each component: within [0, 3 secant].  Where both end slopes are, the cubic
/// is monotone (F. N. Fritsch, R. E. Carlson: Monotone piecewise cubic interpolation.  SIAM J. Numer. Anal.
/// 17, 1980, the square in their figure 1).
/// @param slope, secant  per second, or per segment, both alike
inline Vec3 monotone_slope(const Vec3& slope, const Vec3& secant) {
  return slope.cwiseMax(3.0 * secant.cwiseMin(0.0)).cwiseMin(3.0 * secant.cwiseMax(0.0));
}

}  // namespace palpate::device
