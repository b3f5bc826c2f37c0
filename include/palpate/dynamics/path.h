#pragma once
#include <functional>

#include "palpate/dynamics/rigid_body.h"

/// Motions of rigid frames that are known beforehand.
namespace palpate::dynamics {

/// Pose of a frame, and its first two derivatives (angular and linear, world axes).
struct PathPoint {
  Pose pose;           ///< in the world
  Twist twist;         ///< [rad/s, m/s]
  Twist acceleration;  ///< [rad/s^2, m/s^2]
};
/// A motion as a function of time [s].
using Path = std::function<PathPoint(double t)>;

/// The motion between two known ones, h [s] apart, at s in [0, 1]: position and rotation vector are cubics
/// through both ends with their twists (error O(h^4)); the twist is the pose's exact derivative.
/// @pre the rotation from one to the other is less than a full turn
RigidMotion motion_between(const RigidMotion& from, const RigidMotion& to, double h, double s);

}  // namespace palpate::dynamics
