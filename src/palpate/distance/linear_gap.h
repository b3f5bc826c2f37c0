#pragma once
#include "palpate/core/types.h"

namespace palpate::distance {

/// Integrals over a triangle of area 1 against its hats l_i, the linear functions that are 1 at a corner i
/// and 0 at the others.
struct HatIntegrals {
  Vec3 overlap = Vec3::Zero();  ///< of o+ l_i, o+ the positive part of the overlap
  Vec3 area = Vec3::Zero();     ///< of l_i where the overlap is positive
};

/// Integrates the positive part of a linear function over a triangle, exactly: it is the gradient of
/// 1/2 integral (o+)^2 by the corners' values, and their sum is the integral of o+.  All are at least 0, and
/// once continuously differentiable in the corners' values.
/// @param overlap  at the corners [m]
HatIntegrals integrate_hats(const Vec3& overlap);

/// Means over a triangle of what linear interpolation misses, to first order in the curvature of the surface
/// to which the gap is; exact for a quadratic gap.
struct Missed {
  double gap;     ///< mean of the gap's interpolation less the gap [m]
  double normal;  ///< length that the interpolated unit normals lack, in the mean [-]
};
/// @param x  corners [m]  @param normal  unit gradients of the gap there
Missed missed_by_linear(const Mat3& x, const Mat3& normal);

}  // namespace palpate::distance
