#include "model/bind.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/core/error.h"

namespace palpate::model {

// The ball at parameter t in [0, 1] of the axis has its centre at t L and the radius r0 + t (r1 - r0).  Its
// distance from a point at x along the axis and y off it is
//   f(t) = D(t) - r0 - t (r1 - r0),   D = sqrt((x - t L)^2 + y^2),
// and the bone's distance is the minimum of f.  f is convex (a norm minus a linear function), so the minimum
// is at its stationary point, clamped to [0, 1]:
//   f' = 0:  (x - t L) / D = -s,  s = (r1 - r0) / L,   hence  D = y / sqrt(1 - s^2),  t L = x + s D.
// With |s| >= 1 one end's ball contains the other, and f falls monotonically to the larger one.
double distance_to_bone(const Bone& bone, const Vec3& p) {
  const Vec3 axis = bone.tail - bone.head;
  const double length = axis.norm(), growth = bone.tail_radius - bone.head_radius;
  if (length <= std::abs(growth))
    return growth > 0 ? (p - bone.tail).norm() - bone.tail_radius : (p - bone.head).norm() - bone.head_radius;
  const double x = (p - bone.head).dot(axis) / length, y = (p - bone.head - axis * (x / length)).norm(),
               s = growth / length;
  const double t = std::clamp((x + s * y / std::sqrt(1 - s * s)) / length, 0.0, 1.0);
  return std::hypot(x - t * length, y) - bone.head_radius - t * growth;
}

std::vector<int> bind_nodes(const Points& nodes, const Skeleton& skeleton, double margin) {
  PALPATE_CHECK(margin >= 0, "margin = {}", margin);
  const auto count = static_cast<std::size_t>(nodes.cols());
  std::vector<int> owner(count, -1);
  std::vector<double> best(count, margin);
  for (std::size_t b = 0; b < skeleton.bones.size(); ++b)
    for (std::size_t i = 0; i < count; ++i)
      if (const double d = distance_to_bone(skeleton.bones[b], nodes.col(static_cast<Eigen::Index>(i)));
          d < best[i]) {
        best[i] = d;
        owner[i] = static_cast<int>(b);
      }
  for (int b = 0; b < static_cast<int>(skeleton.bones.size()); ++b) {
    if (std::find(owner.begin(), owner.end(), b) != owner.end()) continue;
    double least = std::numeric_limits<double>::infinity();
    std::size_t nearest = count;
    for (std::size_t i = 0; i < count; ++i) {
      if (owner[i] >= 0) continue;  // belongs to another bone, which could be left without a node
      if (const double d = distance_to_bone(skeleton.bones[static_cast<std::size_t>(b)],
                                            nodes.col(static_cast<Eigen::Index>(i)));
          d < least) {
        least = d;
        nearest = i;
      }
    }
    if (nearest < count) owner[nearest] = b;
  }
  return owner;
}

}  // namespace palpate::model
