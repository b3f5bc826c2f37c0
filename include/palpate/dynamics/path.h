#pragma once
#include <functional>

#include "palpate/dynamics/rigid_body.h"

/// Prescribed motions of rigid frames.
namespace palpate::dynamics {

/// Pose of a frame and its first two time derivatives (angular and linear, world axes).
struct PathPoint {
  Pose pose;           ///< Pose in the world.
  Twist twist;         ///< [rad/s, m/s]
  Twist acceleration;  ///< [rad/s^2, m/s^2]
};
/// Motion as a function of time [s].
using Path = std::function<PathPoint(double t)>;

/// Interpolates between two motions that are h [s] apart, at s in [0, 1]. Position and rotation vector are
/// cubic Hermite interpolants of both ends and their twists (error O(h^4)); the twist is the exact
/// derivative of the pose.
/// @pre the rotation from one to the other is less than a full turn
RigidMotion motion_between(const RigidMotion& from, const RigidMotion& to, double h, double s);

}  // namespace palpate::dynamics
