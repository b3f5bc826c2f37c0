#pragma once
#include "palpate/core/types.h"

namespace palpate {

/// Rigid transform X_AB: p_A = rotation * p_B + translation.  `rotation` is a unit quaternion.
struct Pose {
  Quat rotation = Quat::Identity();  ///< R_AB, of unit length
  Vec3 translation = Vec3::Zero();   ///< [m]

  /// Returns in frame A the point p_B given in frame B [m].
  Vec3 operator*(const Vec3& p) const { return rotation * p + translation; }
  /// Returns X_AC = X_AB X_BC.
  Pose operator*(const Pose& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }
  /// Returns X_BA.
  Pose inverse() const { return {rotation.conjugate(), -(rotation.conjugate() * translation)}; }
};

/// Velocity of a rigid frame in world axes: angular [rad/s], and linear velocity of its origin [m/s].
struct Twist {
  Vec3 angular = Vec3::Zero();  ///< angular velocity [rad/s]
  Vec3 linear = Vec3::Zero();   ///< velocity of the frame's origin [m/s]
  /// Returns the velocity of the point at `arm` = p - origin [m/s], world axes.
  Vec3 at(const Vec3& arm) const { return linear + angular.cross(arm); }
};

/// Moment about the frame's origin [N m] and force [N], world axes.
struct Wrench {
  Vec3 moment = Vec3::Zero();  ///< Moment about the frame's origin [N m].
  Vec3 force = Vec3::Zero();   ///< Force [N].
  /// Adds a wrench about the same point.
  Wrench& operator+=(const Wrench& o) {
    moment += o.moment;
    force += o.force;
    return *this;
  }
};

/// Returns the rotation vector of a unit quaternion, with angle in [0, pi] [rad].  Accurate for small angles;
/// q and -q give the same result.
Vec3 rotation_vector(const Quat& q);

/// Returns the unit quaternion of a rotation vector [rad].
Quat quaternion_of(const Vec3& rotation_vector);

/// Returns the 6-vector (angular, linear) [rad, m] that carries `from` to `to`: rotation vector of
/// to.rotation * from.rotation^-1 (world axes) and to.translation - from.translation.
Vec6 pose_difference(const Pose& from, const Pose& to);

}  // namespace palpate
