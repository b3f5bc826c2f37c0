#pragma once
#include <array>

#include "palpate/core/types.h"

namespace palpate::contact {

/// One side of a contact sample: a point of a soft body (weighted nodes) or of a rigid frame.
struct SurfacePoint {
  int frame = -1;                  ///< Index of a MovingFrame; -1: weighted nodes.
  int count = 0;                   ///< Number of nodes, at most 4.
  std::array<int, 4> node{};       ///< Nodes, counted over all node blocks (rows 3 node .. 3 node + 2 of u).
  std::array<double, 4> weight{};  ///< Weights of the nodes; sum 1, may be slightly negative at edges.
  /// Nodes: world offset added to the weighted position [m]. Frame: point in the frame's axes [m].
  Vec3 offset = Vec3::Zero();
  /// Frame: displacement from that point to the surface point, along the sample's normal, in world axes [m].
  /// It does not rotate with the frame. On a curved surface `offset` is the centre of curvature: a surface
  /// that rotates about this centre keeps its position, and so do the point, its gap and its force.
  Vec3 slide = Vec3::Zero();
};

/// Two surface points on one line along `normal`, and the area that they represent. gap =
/// normal . (x_a - x_b); negative is penetration. The force on a is p area normal; the force on b is its
/// opposite.
struct ContactSample {
  SurfacePoint a, b;            ///< Points on the two surfaces.
  Vec3 normal = Vec3::UnitZ();  ///< Unit normal from b to a: the force on a points along it.
  double area = 0.0;            ///< Area projected on the contact plane [m^2]; 1 for springs per point.
  double gap = 0.0;             ///< Gap at the query [m].
  /// Ratio of the stored energy to the energy of a spring with this area and gap, for a sample that
  /// represents a varying gap: the gap at the point divided by the mean gap. It is negative for a point
  /// outside whose surroundings overlap.
  double stored = 1.0;
  /// Deflection of the friction spring divided by its retardation time [m/s]; the sliding velocity is the
  /// velocity of the material plus this (src/contact/friction_anchors.cpp).
  Vec3 deflection_rate = Vec3::Zero();
  int source = 0;  ///< Index of the contact pair that made the sample.
};

}  // namespace palpate::contact
