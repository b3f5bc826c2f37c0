#pragma once
#include <array>

#include "palpate/contact/sample.h"
#include "palpate/core/types.h"

namespace palpate::contact {

using Vec4 = Eigen::Vector4d;
using Mat4 = Eigen::Matrix4d;
using Mat34 = Eigen::Matrix<double, 3, 4>;

/// What carries the points of a surface near one place of a region: the nodes of a tetrahedron, those of a
/// face, or a frame.
///
/// A point is named by its place (u, v, w) in the region's axes as they stood at the query.  Weights of nodes
/// are barycentric coordinates, so they are affine in the place, and so is a rigid point in its frame's axes:
/// points that share a carrier need no weights of their own.
struct Carrier {
  int number = 0;  ///< the side's, of what carries (ImageSide::carrier)
  int frame = -1;  ///< index of a MovingFrame, or -1: nodes
  int count = 0;   ///< nodes
  std::array<int, 4> node{};
  Vec3 at = Vec3::Zero();  ///< a place near it, that others are counted from [m]: rounding stays small
  /// times (u, v, w, 1) from there: of nodes a weight a row, zero beyond `count`; of a frame the point in its
  /// axes [m] in three rows, and 1
  Mat4 by_place = Mat4::Zero();
  /// times (u, v, w, 1) from there: by how much the point lies further along the normal than what the nodes
  /// carry [m]
  Vec4 beside = Vec4::Zero();
};

/// The point at a place, counted from the carrier's `at`.  @param normal  the axes' w
SurfacePoint point_of(const Carrier& carrier, const Vec3& from_carrier, const Vec3& normal);

/// One point of a surface, and the number of what carries it.
struct CarriedPoint {
  SurfacePoint point;
  int number = 0;  ///< as Carrier::number
};

}  // namespace palpate::contact
