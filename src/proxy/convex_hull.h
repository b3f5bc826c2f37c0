#pragma once
#include <vector>

#include "palpate/core/types.h"

namespace palpate::proxy {

/// A convex hull by Qhull (Barber, Dobkin, Huhdanpaa 1996), for points in any position: flat sets, lines and
/// single points have hulls too.
struct ConvexHull {
  std::vector<int> corners;  ///< its extreme points, ascending
  /// unit; inside is normals^T x <= offsets.  A flat hull has its plane twice, once a side
  Points normals;
  VecX offsets;         ///< [m]
  double volume = 0.0;  ///< [m^3]; 0 for flat ones

  /// How far a point lies beyond the farthest of the planes; negative inside.
  /// At most its distance from the hull [m].
  double beyond(const Vec3& point) const { return (normals.transpose() * point - offsets).maxCoeff(); }
};
/// @throws InternalError for no points, or points that are not finite
ConvexHull convex_hull(const Points& points);

/// At most `count` of the points whose hull misses the others least, greedily: the farthest outside joins,
/// until none is outside by more than `tolerance`.
std::vector<int> greedy_corners(const Points& points, int count, double tolerance);

}  // namespace palpate::proxy
