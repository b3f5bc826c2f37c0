#pragma once
#include "palpate/core/types.h"

namespace palpate::device {

/// Returns the slope nearest to `slope` with which the Hermite cubic over a segment of mean slope `secant`
/// stays between the segment's ends: each component limited to [0, 3 secant]. If both end slopes satisfy
/// this, the cubic is monotone (F. N. Fritsch, R. E. Carlson: Monotone piecewise cubic interpolation. SIAM J.
/// Numer. Anal. 17, 1980, the square in their figure 1).
/// @param slope, secant  in the same unit, per second or per segment
inline Vec3 monotone_slope(const Vec3& slope, const Vec3& secant) {
  return slope.cwiseMax(3.0 * secant.cwiseMin(0.0)).cwiseMin(3.0 * secant.cwiseMax(0.0));
}

}  // namespace palpate::device
