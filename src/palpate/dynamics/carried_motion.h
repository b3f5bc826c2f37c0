#pragma once
#include <vector>

#include "palpate/dynamics/rigid_body.h"

namespace palpate::dynamics {

/// Single directions of points p that a rigid frame carries along, r = R p:
///     x = o + r,     v = o' + w x r,     a = o'' + w' x r + w x (w x r).
/// @param acceleration  of the frame: w' and o''  @param dofs  3 node + axis, of which the axis counts
///   here, one a point
/// @param local  the points in the frame [m], 3 x dofs  @param x, v, a  one number a direction
void carry(const RigidMotion& frame, const Twist& acceleration, const std::vector<int>& dofs,
           const Points& local, VecX& x, VecX& v, VecX& a);

}  // namespace palpate::dynamics
