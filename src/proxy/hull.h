#pragma once
#include "palpate/core/types.h"

namespace palpate::proxy {

/// A point set as the convex hull that it spans.
struct Hull {
  const Points& points;
  Vec3 centre;

  explicit Hull(const Points& p) : points(p), centre(p.rowwise().mean()) {}
  /// Its point farthest along a direction; the first of equals.
  Vec3 support(const Vec3& direction) const {
    Eigen::Index best = 0;
    double most = direction.dot(points.col(0));
    for (Eigen::Index i = 1; i < points.cols(); ++i) {
      const double along = direction.dot(points.col(i));
      if (along > most) {
        most = along;
        best = i;
      }
    }
    return points.col(best);
  }
};

/// Depth along a unit direction n from b to a: how far a must move along n to be clear of b; negative when it is.
struct DepthAlong {
  double depth;
  Vec3 lowest_a, highest_b;
};
inline DepthAlong depth_along(const Hull& a, const Hull& b, const Vec3& n) {
  const Vec3 low = a.support(-n), high = b.support(n);
  return {n.dot(high - low), low, high};
}

/// The algorithm of Gilbert, Johnson and Keerthi (1988) on the difference a - b: its point nearest to the origin (the direction is judged by the caller:
/// every direction with negative depth proves that the hulls are apart).  Zero where the hulls overlap.
Vec3 nearest_difference(const Hull& a, const Hull& b);

}  // namespace palpate::proxy
