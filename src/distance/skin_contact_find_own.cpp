// Springs of self-contact: which points are searched, and which overlaps count as contact.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "distance/lane_search.h"
#include "distance/skin_contact.h"

namespace palpate::distance {

void SkinContact::find_own(const double* nodes, double near, const Approach& approach) {
  approach_ = approach;
  find(nodes, nodes, near);
  approach_ = {};
}

/// Returns whether an outside point may reach its foot before the next query, or is closer than the distance
/// that is always kept.
bool SkinContact::may_come_near(const ContactPoint& point, const Foot& foot) const {
  if (!approach_.velocities) return true;
  const Skin& skin = surfaces_[0].skin();
  const auto velocity = [&](int face, const Vec3& weights) {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const int v = skin.faces(k, face);
      for (int j = 0; j < 4; ++j)
        sum += weights[k] * skin.weights(j, v) *
               Eigen::Map<const Vec3>(approach_.velocities + 3 * std::ptrdiff_t{skin.nodes(j, v)});
    }
    return sum;
  };
  const Vec3 relative = velocity(point.face, point.weights) - velocity(foot.face, foot.at.weights);
  return std::sqrt(foot.at.distance2) < approach_.gap_m + approach_.time_s * relative.norm();
}

/// Returns whether a point behind its foot counts as an overlap. Between two different skins it always does.
bool SkinContact::overlaps(const ContactPoint& point, const Vec3& x, const Foot& foot) const {
  if (!own_) return true;
  return foot.at.distance2 < own_->depth() * own_->depth() && own_->is_overlap(point, x, foot);
}

// The side of the skin on which a point lies is known only where its nearest point is close enough. Points
// known to be outside need no search until the skin has moved by their distance; all others are searched
// whenever their cluster is near another one.
void SkinContact::find_clusters_of_own(double near) {
  mark_near_itself();
  const std::vector<SideOfSurface>& where = where_[0];
  for (std::size_t c = 0; c < where.size(); ++c)
    if (where[c] == SideOfSurface::kNear && clear_[0][c] < travelled_ + near)
      find_cluster(*searchers_.front(), 0, static_cast<int>(c), -1, near, springs_);
}

/// Marks the clusters that are within the depth of overlaps of another cluster that they may touch. All
/// pairs of boxes are traversed from the root of the tree.
void SkinContact::mark_near_itself() {
  const Surface& own = surfaces_[0];
  const std::vector<ClusterNode>& tree = own.skin().tree;
  std::vector<SideOfSurface>& where = where_[0];
  std::fill(where.begin(), where.end(), SideOfSurface::kOutside);
  const double within2 = own_->depth() * own_->depth();
  const auto apart2 = [&](int i, int j) { return own.box(i).squaredExteriorDistance(own.box(j)); };
  // Each pop pushes three entries at most and descends one level in one of two trees of fewer than 64 levels.
  std::array<std::pair<int, int>, 3 * 2 * 64> open;
  std::size_t count = 0;
  open[count++] = {0, 0};
  while (count > 0) {
    const auto [i, j] = open[--count];
    const ClusterNode &a = tree[static_cast<std::size_t>(i)], &b = tree[static_cast<std::size_t>(j)];
    if (i == j) {
      if (!a.right) continue;
      open[count++] = {i + 1, i + 1};
      open[count++] = {a.right, a.right};
      open[count++] = {i + 1, a.right};
    } else if (apart2(i, j) > within2) {
      continue;
    } else if (a.right && (!b.right || a.end - a.begin >= b.end - b.begin)) {
      open[count++] = {i + 1, j};
      open[count++] = {a.right, j};
    } else if (b.right) {
      open[count++] = {i, j + 1};
      open[count++] = {i, b.right};
    } else if (own_->neighbours.may_touch(a.begin, b.begin)) {
      own.place(a.begin);
      own.place(b.begin);
      if (apart2(i, j) > within2) continue;
      where[static_cast<std::size_t>(a.begin)] = where[static_cast<std::size_t>(b.begin)] =
          SideOfSurface::kNear;
    }
  }
}

}  // namespace palpate::distance
