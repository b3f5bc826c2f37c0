// Search for the contact points that lie inside the other skin or near it, and for their feet.
//
// A box of one skin that intersects no cluster box of the other lies entirely inside or entirely outside. The
// signed distance to a closed skin is 1-Lipschitz: a point outside stays outside until the skins have moved
// relative to each other by its distance. No maximum depth is assumed: deeply penetrating points are found
// like all others.
#include <algorithm>
#include <cmath>
#include <limits>

#include "distance/skin_contact_impl.h"

namespace palpate::distance {
namespace {

Eigen::AlignedBox3d widened(const Eigen::AlignedBox3d& box, double by) {
  return {box.min() - Vec3::Constant(by), box.max() + Vec3::Constant(by)};
}

}  // namespace

void SkinContact::move(const double* nodes_a, const double* nodes_b, Surface::Tree tree) {
  surfaces_[0].move(nodes_a, tree);
  surfaces_[1].move(nodes_b, tree);
  positions_.nodes[0] = nodes_a;
  positions_.nodes[1] = nodes_b;
  ++positions_.moved;
  positions_.fitted += tree == Surface::Tree::kFit;
  const double step = (surfaces_[0].stretch() + surfaces_[1].stretch() +
                       (surfaces_[0].shift() - surfaces_[1].shift()).norm()) *
                      (1.0 + kMarginOfBounds);
  if (std::isfinite(step)) {
    travelled_ += step;
    return;
  }
  // The first positions, or positions that follow non-finite ones: the displacement is unknown.
  for (int side = 0; side < 2; ++side) {
    std::fill(clear_[side].begin(), clear_[side].end(), -1.0);
    std::fill(packets_clear_[side].begin(), packets_clear_[side].end(), -1.0);
  }
  for (Spring& spring : springs_) spring.clear = 0.0;
}

/// Returns whether fourth powers of coordinates, which occur in squared areas, are representable in single
/// precision, as the search requires. Coordinates of a million kilometres occur only after divergence.
bool SkinContact::is_searchable() const {
  constexpr double kLargest = 1e9;  // [m]
  for (const Surface& s : surfaces_)
    if (!(s.bound().min().cwiseAbs().maxCoeff() < kLargest &&
          s.bound().max().cwiseAbs().maxCoeff() < kLargest))
      return false;
  return true;
}

void SkinContact::find(const double* nodes_a, const double* nodes_b, double near) {
  move(nodes_a, nodes_b, Surface::Tree::kFit);
  springs_.clear();
  triangles_.clear();
  if (!is_searchable()) return;
  const double reach = near + std::max(most_lowered_[0], most_lowered_[1]);
  const Eigen::AlignedBox3d both =
      widened(surfaces_[0].bound(), reach).intersection(widened(surfaces_[1].bound(), reach));
  if (both.isEmpty()) return;
  for (int side = 0; side < 2; ++side) {
    if (points(side).empty()) continue;
    begin_search(1 - side, both.center(), surfaces_[side].bound());
    if (own_)
      find_clusters_of_own(std::min(near, own_->depth()));
    else
      find_side(side, near + most_lowered_[side]);
  }
  find_triangles();
  list_missing();
  follow_packets(missing_);
  integrate();
}

/// Lists the corners of overlapping triangles that are not placed yet, in ascending order.
void SkinContact::list_missing() {
  missing_.clear();
  for (const Triangle& t : triangles_) {
    const double lowered = triangle(t.side, t.number).lowered;
    bool overlaps = false;
    for (const int i : t.spring) {
      const Spring& s = springs_[static_cast<std::size_t>(i)];
      overlaps |= s.is_placed && s.gap < lowered;
    }
    for (const int i : t.spring)
      if (overlaps && !springs_[static_cast<std::size_t>(i)].is_placed)
        missing_.push_back(static_cast<std::size_t>(i));
  }
  std::sort(missing_.begin(), missing_.end());
  missing_.erase(std::unique(missing_.begin(), missing_.end()), missing_.end());
}

void SkinContact::follow(const double* nodes_a, const double* nodes_b) {
  move(nodes_a, nodes_b, Surface::Tree::kKeep);  // Few clusters are near the springs.
  if (springs_.empty()) return;
  if (!is_searchable()) {
    for (Spring& spring : springs_) spring.is_placed = false;
    return integrate();
  }
  const Eigen::AlignedBox3d both = surfaces_[0].bound().merged(surfaces_[1].bound());
  for (const int side : {0, 1}) begin_search(side, both.center(), both);
  missing_.clear();
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    Spring& spring = springs_[i];
    spring.is_placed = false;
    if (travelled_ + most_lowered_[spring.side] < spring.clear && spring.force == 0.0) continue;
    missing_.push_back(i);
  }
  follow_packets(missing_);
  list_missing();
  follow_packets(missing_);
  integrate();
}

/// Returns the distance of a box from the cluster boxes of the other skin, or any smaller value than `near`
/// if it is below `near`.
/// @param near_leaf  in: leaf nearest to the previous box, tested first; out: leaf nearest to this one
double SkinContact::gap_of(int side, const Eigen::AlignedBox3d& box, double near, int& near_leaf) const {
  const Surface& other = surfaces_[1 - side];
  double least2 = std::numeric_limits<double>::infinity();
  const auto take = [&](int leaf) {
    other.place(other.skin().tree[static_cast<std::size_t>(leaf)].begin);
    const double distance2 = other.box(leaf).squaredExteriorDistance(box);
    if (!(distance2 < least2)) return;
    least2 = distance2;
    near_leaf = leaf;
  };
  if (near_leaf >= 0) take(near_leaf);
  int open[64], depth = 0;
  open[depth++] = 0;
  while (depth > 0 && least2 > near * near) {
    const int i = open[--depth];
    if (other.box(i).squaredExteriorDistance(box) >= least2) continue;
    const ClusterNode& node = other.skin().tree[static_cast<std::size_t>(i)];
    if (!node.right) {
      take(i);
      continue;
    }
    const bool is_left_nearer =
        other.box(i + 1).squaredExteriorDistance(box) <= other.box(node.right).squaredExteriorDistance(box);
    open[depth++] = is_left_nearer ? node.right : i + 1;
    open[depth++] = is_left_nearer ? i + 1 : node.right;
  }
  return std::sqrt(least2) * (1.0 - kMarginOfBounds);
}

// A box with a gap to the other skin contains no part of it: its contents lie entirely inside or entirely
// outside, and no nearer than that gap. Parts of a skin that share a vertex lie on the same side, so that
// everything connected to a part that is known to be outside is outside too. For each remaining component one
// point is tested.
void SkinContact::find_side(int side, double near) {
  const Surface& own = surfaces_[side];
  const Eigen::AlignedBox3d reach = widened(surfaces_[1 - side].box(0), near);
  const std::vector<ClusterNode>& tree = own.skin().tree;
  std::vector<double>& clear = clear_[side];
  std::vector<SideOfSurface>& where = where_[side];
  std::fill(where.begin(), where.end(), SideOfSurface::kOutside);
  whole_.clear();
  int near_leaf = -1, open[64], depth = 0;
  open[depth++] = 0;
  while (depth > 0) {
    const int i = open[--depth];
    const ClusterNode& node = tree[static_cast<std::size_t>(i)];
    if (!own.box(i).intersects(reach)) continue;
    const auto begin = clear.begin() + node.begin, end = clear.begin() + node.end;
    if (std::all_of(begin, end, [&](double c) { return c >= travelled_ + near; })) continue;
    if (!node.right) own.place(node.begin);
    const double gap = gap_of(side, own.box(i), near, near_leaf);
    if (gap > near) {
      for (int c = node.begin; c < node.end; ++c) {
        where[static_cast<std::size_t>(c)] = SideOfSurface::kWhole;
        clear[static_cast<std::size_t>(c)] = std::max(clear[static_cast<std::size_t>(c)], travelled_ + gap);
        whole_.push_back({c, i});
      }
    } else if (node.right) {
      open[depth++] = node.right;
      open[depth++] = i + 1;
    } else {
      where[static_cast<std::size_t>(node.begin)] = SideOfSurface::kNear;
    }
  }
  for (const Part& part : whole_)
    if (where[static_cast<std::size_t>(part.cluster)] == SideOfSurface::kWhole) settle(side, part);
  search_clusters(side, near);
}

/// Classifies all clusters connected to one, each of them entirely on one side, as inside or outside.
void SkinContact::settle(int side, const Part& part) {
  const Surface& own = surfaces_[side];
  const Surface& other = surfaces_[1 - side];
  const Skin& skin = own.skin();
  std::vector<SideOfSurface>& where = where_[side];
  bool is_outside = false;
  joined_.clear();
  joined_.push_back(part.cluster);
  where[static_cast<std::size_t>(part.cluster)] = SideOfSurface::kInside;
  for (std::size_t i = 0; i < joined_.size(); ++i) {
    const auto c = static_cast<std::size_t>(joined_[i]);
    for (int k = skin.joined_begin[c]; k < skin.joined_begin[c + 1]; ++k) {
      SideOfSurface& at = where[static_cast<std::size_t>(skin.joined[static_cast<std::size_t>(k)])];
      is_outside |= at == SideOfSurface::kOutside;
      if (at != SideOfSurface::kWhole) continue;
      at = SideOfSurface::kInside;
      joined_.push_back(skin.joined[static_cast<std::size_t>(k)]);
    }
  }
  if (!is_outside) is_outside = !other.is_inside(other.nearest(own.box(part.tree_node).center()));
  for (const int c : joined_) {
    if (is_outside)
      where[static_cast<std::size_t>(c)] = SideOfSurface::kOutside;
    else
      clear_[side][static_cast<std::size_t>(c)] = -1.0;
  }
}

void SkinContact::find_by_reference(const double* nodes_a, const double* nodes_b) {
  move(nodes_a, nodes_b, Surface::Tree::kFit);
  springs_.clear();
  find_side_by_reference(0);
  find_side_by_reference(1);
  find_triangles();
  list_missing();
  for (const std::size_t i : missing_) {
    Spring& s = springs_[i];
    const Foot foot = surfaces_[1 - s.side].nearest(position(s), s.face);
    set_foot(s, foot, surfaces_[1 - s.side].is_inside(foot));
  }
  integrate();
}

void SkinContact::find_side_by_reference(int side) {
  if (points(side).empty()) return;
  const Surface& own = surfaces_[side];
  const Surface& other = surfaces_[1 - side];
  for (std::size_t i = 0; i < own.skin().tree.size(); ++i) {
    const ClusterNode& node = own.skin().tree[i];
    if (node.right) continue;
    own.place(node.begin);
    const Eigen::AlignedBox3d box = own.box(static_cast<int>(i));
    if (!box.intersects(widened(other.bound(), most_lowered_[side]))) continue;
    const Foot middle = other.nearest(box.center());
    const double radius = 0.5 * box.diagonal().norm();
    if (std::sqrt(middle.at.distance2) > (radius + most_lowered_[side]) * (1.0 + kMarginOfBounds) &&
        !other.is_inside(middle))
      continue;
    int start = middle.face;
    const auto cluster = static_cast<std::size_t>(node.begin);
    for (int p = cluster_points_[side][cluster]; p < cluster_points_[side][cluster + 1]; ++p) {
      const Foot foot = other.nearest(position(side, points(side)[static_cast<std::size_t>(p)]), start);
      start = foot.face;
      const bool is_inside = other.is_inside(foot);
      if (is_inside || std::sqrt(foot.at.distance2) < most_lowered_[side])
        add_spring(side, p, foot, is_inside, springs_);
    }
  }
}

}  // namespace palpate::distance
