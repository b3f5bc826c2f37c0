#pragma once
#include <array>

#include "palpate/core/types.h"

namespace palpate::contact {

/// One side of a contact sample: a point of a soft body (weighted nodes) or of a rigid frame.
struct SurfacePoint {
  int frame = -1;                  ///< index of a MovingFrame, or -1: weighted nodes
  int count = 0;                   ///< nodes used, at most 4
  std::array<int, 4> node{};       ///< counted over all node blocks (rows 3 node .. 3 node + 2 of u)
  std::array<double, 4> weight{};  ///< sum to one; may be slightly negative at edges
  /// nodes: world offset added to the weighted position; frame: a point in the frame's axes [m]
  Vec3 offset = Vec3::Zero();
  /// Frames: from there to the surface point, along the sample's normal, in the world's axes: it does not
  /// rotate with the frame [m].  On a round surface `offset` is the centre of curvature: the surface that
  /// rotates about it stays where it was, and so do the point, its gap and its force.
  Vec3 slide = Vec3::Zero();
};

/// Two surface points on one line along `normal`, and what they stand for.  gap = normal . (x_a - x_b);
/// negative is penetration.  The force on a is p area normal, on b its opposite.
struct ContactSample {
  SurfacePoint a, b;            ///< on the two surfaces
  Vec3 normal = Vec3::UnitZ();  ///< unit, from b to a: pushes a away
  double area = 0.0;            ///< projected on the contact plane [m^2]; 1 where springs are per point
  double gap = 0.0;             ///< at the query [m]
  /// Energy over that of a spring of this area and gap, where the sample stands for a gap that varies: the
  /// point's own gap over the mean one, below 0 of a point outside whose surroundings overlap.
  double stored = 1.0;
  /// Deflection of friction's spring over its retardation time [m/s]: sliding is the material's velocity and
  /// this (src/contact/friction_anchors.cpp).
  Vec3 deflection_rate = Vec3::Zero();
  int source = 0;  ///< index of the contact pair that made it
};

}  // namespace palpate::contact
