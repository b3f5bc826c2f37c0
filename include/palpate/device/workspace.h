#pragma once
#include "palpate/core/types.h"

namespace palpate::device {

/// Region that a device can reach: a box along the scene's axes, a ball, their intersection, or everywhere.
/// The device's encoders should not report a pose outside it, and forces fade there.
struct Workspace {
  Vec3 center = Vec3::Zero();  ///< Centre of box and ball [m].
  Vec3 size = Vec3::Zero();    ///< Extents of the box [m]; zero: no box.
  double radius = 0.0;         ///< Radius of the ball [m]; 0: no ball.
  double margin = 0.01;        ///< Distance outside over which a force fades to zero [m].

  /// Returns whether there is a box or a ball.
  bool is_bounded() const { return radius > 0.0 || !size.isZero(0.0); }
  double distance_outside(const Vec3& p) const;  ///< Distance [m]; 0 inside.
  /// Returns the factor of a force at p: 1 inside, decreasing to 0 at `margin` outside (C1); 0 if p is not
  /// finite.
  double share(const Vec3& p) const;
};

}  // namespace palpate::device
