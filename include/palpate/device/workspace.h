#pragma once
#include "palpate/core/types.h"

namespace palpate::device {

/// Where a device can be: a box along the scene's axes, a ball, or everywhere.  Outside of it a pose is one
/// that the device's encoders should not give, and forces fade there.
struct Workspace {
  Vec3 center = Vec3::Zero();  ///< [m]
  Vec3 size = Vec3::Zero();    ///< extents of the box [m]; zero: no box
  double radius = 0.0;         ///< of the ball [m]; 0: no ball
  double margin = 0.01;        ///< distance outside over which a force fades to nothing [m]

  /// Whether there is a box or a ball.
  bool is_bounded() const { return radius > 0.0 || !size.isZero(0.0); }
  double distance_outside(const Vec3& p) const;  ///< [m]; 0 inside
  /// What is left of a force at p: 1 inside, C1 down to 0 at `margin` outside; 0 where p is not finite.
  double share(const Vec3& p) const;
};

}  // namespace palpate::device
