#pragma once
#include <vector>

#include "palpate/core/types.h"

namespace palpate::proxy {

/// Convex hull by Qhull (Barber, Dobkin, Huhdanpaa 1996), for points in any position: flat sets, lines and
/// single points have hulls too.
struct ConvexHull {
  std::vector<int> corners;  ///< indices of the extreme points, ascending
  /// Unit; the inside is normals^T x <= offsets.  A flat hull has its plane twice, once per side.
  Points normals;
  VecX offsets;         ///< [m]
  double volume = 0.0;  ///< [m^3]; 0 for flat ones

  /// Returns how far a point lies beyond the farthest of the planes; negative inside.  At most its distance
  /// from the hull [m].
  double beyond(const Vec3& point) const { return (normals.transpose() * point - offsets).maxCoeff(); }
};
/// Computes the hull of points [m], 3 x n.
/// @throws InternalError for no points, or points that are not finite
ConvexHull convex_hull(const Points& points);

/// Returns the indices, ascending, of at most `count` points whose hull covers the others well.  Greedy: the
/// point farthest outside joins, until none is outside by more than `tolerance` [m].
std::vector<int> greedy_corners(const Points& points, int count, double tolerance);

}  // namespace palpate::proxy
