#pragma once
#include <array>

#include "palpate/contact/sample.h"
#include "palpate/core/types.h"

namespace palpate::contact {

using Vec4 = Eigen::Vector4d;
using Mat4 = Eigen::Matrix4d;
using Mat34 = Eigen::Matrix<double, 3, 4>;

/// Carrier of the points of a surface near one place of a region: the nodes of a tetrahedron, the nodes of a
/// face, or a frame.
///
/// A point is identified by its place (u, v, w) in the region's axes at the query. Weights of nodes are
/// barycentric coordinates and therefore affine in the place, and so is a rigid point in its frame's axes.
/// Points that share a carrier need no separate weights.
struct Carrier {
  int number = 0;  ///< Number of the carrier on its side (ImageSide::carrier).
  int frame = -1;  ///< Index of a MovingFrame; -1: nodes.
  int count = 0;   ///< Number of nodes.
  std::array<int, 4> node{};
  /// Reference place near the carrier, from which places are measured to keep rounding errors small [m].
  Vec3 at = Vec3::Zero();
  /// Matrix applied to (u, v, w, 1), measured from `at`. Nodes: one weight per row, zero beyond `count`.
  /// Frame: the point in the frame's axes [m] in three rows, and 1.
  Mat4 by_place = Mat4::Zero();
  /// Row applied to (u, v, w, 1), measured from `at`: distance along the normal of the point from the point
  /// carried by the nodes [m].
  Vec4 beside = Vec4::Zero();
};

/// Returns the point at a place, measured from the carrier's `at`. @param normal  w axis of the region
SurfacePoint point_of(const Carrier& carrier, const Vec3& from_carrier, const Vec3& normal);

/// Point of a surface, and the number of its carrier.
struct CarriedPoint {
  SurfacePoint point;
  int number = 0;  ///< As Carrier::number.
};

}  // namespace palpate::contact
