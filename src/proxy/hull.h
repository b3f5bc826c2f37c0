#pragma once
#include <vector>

#include "palpate/core/types.h"
#include "proxy/lanes.h"

namespace palpate::proxy {

/// Point set as the convex hull that it spans, stored as columns of coordinates.
class Hull {
 public:
  Hull() = default;
  explicit Hull(const Points& points) { assign(points, Vec3::Zero(), 1.0); }
  /// Sets the points to scale (p - origin).  Allocates only when there are more points than ever before.
  void assign(const Eigen::Ref<const Points>& points, const Vec3& origin, double scale);
  const Vec3& centre() const { return centre_; }
  /// Returns the point farthest along a direction; the first of equals.
  Vec3 support(const Vec3& direction) const {
    const auto i = static_cast<std::size_t>(
        farthest({x_.data(), y_.data(), z_.data()}, static_cast<int>(x_.size()), direction.data()));
    return {x_[i], y_[i], z_[i]};
  }

 private:
  std::vector<double> x_, y_, z_;
  Vec3 centre_ = Vec3::Zero();
};

/// Depth along a unit direction n from b to a: the distance that a must move along n to be clear of b;
/// negative if it is clear.
struct DepthAlong {
  double depth;
  Vec3 lowest_a, highest_b;
};
/// Computes the depth of a and b along n, with the two support points.
inline DepthAlong depth_along(const Hull& a, const Hull& b, const Vec3& n) {
  const Vec3 low = a.support(-n), high = b.support(n);
  return {n.dot(high - low), low, high};
}

/// Returns the point of the difference a - b nearest to the origin, by the algorithm of Gilbert, Johnson and
/// Keerthi (1988); zero where the hulls overlap.  The caller judges the direction: every direction with
/// negative depth proves that the hulls are apart.
Vec3 nearest_difference(const Hull& a, const Hull& b);

}  // namespace palpate::proxy
