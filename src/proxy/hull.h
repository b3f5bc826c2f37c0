#pragma once
#include <vector>

#include "palpate/core/types.h"
#include "proxy/lanes.h"

namespace palpate::proxy {

/// A point set as the convex hull that it spans, its coordinates side by side.
class Hull {
 public:
  Hull() = default;
  explicit Hull(const Points& points) { assign(points, Vec3::Zero(), 1.0); }
  /// The points scale (p - origin).  Allocates only when there are more than ever before.
  void assign(const Eigen::Ref<const Points>& points, const Vec3& origin, double scale);
  const Vec3& centre() const { return centre_; }
  /// Its point farthest along a direction; the first of equals.
  Vec3 support(const Vec3& direction) const {
    const auto i = static_cast<std::size_t>(
        farthest({x_.data(), y_.data(), z_.data()}, static_cast<int>(x_.size()), direction.data()));
    return {x_[i], y_[i], z_[i]};
  }

 private:
  std::vector<double> x_, y_, z_;
  Vec3 centre_ = Vec3::Zero();
};

/// Depth along a unit direction n from b to a:
/// how far a must move along n to be clear of b; negative when it is.
struct DepthAlong {
  double depth;
  Vec3 lowest_a, highest_b;
};
inline DepthAlong depth_along(const Hull& a, const Hull& b, const Vec3& n) {
  const Vec3 low = a.support(-n), high = b.support(n);
  return {n.dot(high - low), low, high};
}

/// The algorithm of Gilbert, Johnson and Keerthi (1988) on the difference a - b: its point nearest to the
/// origin (the direction is judged by the caller:
/// every direction with negative depth proves that the hulls are apart).  Zero where the hulls overlap.
Vec3 nearest_difference(const Hull& a, const Hull& b);

}  // namespace palpate::proxy
