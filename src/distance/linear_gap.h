#pragma once
#include "palpate/core/types.h"

namespace palpate::distance {

/// Integrals over a triangle of area 1, weighted with its three hat functions l_i, the linear functions that
/// are 1 at corner i and 0 at the others.
struct HatIntegrals {
  Vec3 overlap = Vec3::Zero();  ///< Integral of o+ l_i, with o+ the positive part of the overlap [m].
  Vec3 area = Vec3::Zero();     ///< Integral of l_i over the part where the overlap is positive [-].
};

/// Integrates the positive part of a linear overlap over a triangle of area 1, exactly. `overlap` of the
/// result is the gradient of 1/2 integral (o+)^2 with respect to the corner values, and its entries sum to
/// the integral of o+. All results are nonnegative; `overlap` is once continuously differentiable in the
/// corner values.
/// @param overlap  overlap at the three corners [m]
HatIntegrals integrate_hats(const Vec3& overlap);

/// Mean error of linear interpolation over a triangle, to first order in the curvature of the surface to
/// which the gap is measured; exact for a quadratic gap.
struct Missed {
  double gap;     ///< Mean of the interpolated gap minus the gap [m].
  double normal;  ///< One minus the mean length of the interpolated unit normals [-].
};
/// Estimates the interpolation error of gap and normal on one triangle.
/// @param x  corners [m], one per column  @param normal  unit gradients of the gap at the corners, one per
///   column
Missed missed_by_linear(const Mat3& x, const Mat3& normal);

}  // namespace palpate::distance
