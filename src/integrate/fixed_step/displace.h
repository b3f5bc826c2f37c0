#pragma once
#include "palpate/dynamics/layout.h"

namespace palpate::integrate {

/// Computes q1 = q0 (+) theta, the configuration reached by a displacement theta along u-directions, [m] for
/// nodes and [rad] for a rotation in world axes:
///     q1 = q0 + N((q0 + q1)/2) theta.
/// On nodes this is the sum. On a rigid body q' = N(q) u is linear in the quaternion, so the rule is Cayley's
/// map, a rotation by 4 atan(|theta|/4) = |theta| + O(|theta|^3) that preserves the quaternion's length. It
/// is of order 2 where theta is the integral of the angular velocity over a step, and exactly the implicit
/// midpoint rule where theta = h u_mid.
/// Solved to rounding by fixed-point iteration, which contracts by |theta|/4.
/// @param layout  blocks of q and u
/// @param q0  start, layout.q_size entries
/// @param theta  displacement, layout.u_size entries
/// @param q1  result, layout.q_size entries
/// @param scratch  resized here
/// @return  false where it does not converge (more than half a revolution in one step) or is not finite
bool displace(const dynamics::Layout& layout, const double* q0, const double* theta, double* q1,
              VecX& scratch);

}  // namespace palpate::integrate
