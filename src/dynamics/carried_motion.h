#pragma once
#include <vector>

#include "palpate/dynamics/rigid_body.h"

namespace palpate::dynamics {

/// Computes the motion of points p, one direction each, that a rigid frame carries along, r = R p:
///     x = o + r,     v = o' + w x r,     a = o'' + w' x r + w x (w x r).
/// @param frame  pose and twist of the frame: R, o, w and o'
/// @param acceleration  acceleration of the frame: w' and o''
/// @param dofs  3 node + axis, one per point; only the axis is used here
/// @param local  the points in the frame [m], 3 x dofs.size()
/// @param x, v, a  one number per point: the component along its axis [m, m/s, m/s^2]
void carry(const RigidMotion& frame, const Twist& acceleration, const std::vector<int>& dofs,
           const Points& local, VecX& x, VecX& v, VecX& a);

}  // namespace palpate::dynamics
