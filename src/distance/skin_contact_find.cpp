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

/// Relative margin of bounds, for the rounding of the few operations that produce them.
constexpr double kRounding = 1e-12;

Eigen::AlignedBox3d widened(const Eigen::AlignedBox3d& box, double by) {
  return {box.min() - Vec3::Constant(by), box.max() + Vec3::Constant(by)};
}

/// Collects the distinct faces of a packet, padded with -1.
template <std::size_t count>
void keep_faces(const Packet& packet, std::array<int, count>& faces) {
  std::size_t kept = 0;
  for (const int face : packet.face)
    if (std::find(faces.begin(), faces.begin() + kept, face) == faces.begin() + kept) faces[kept++] = face;
  std::fill(faces.begin() + kept, faces.end(), -1);
}

}  // namespace

void SkinContact::move(const double* nodes_a, const double* nodes_b, Surface::Tree tree) {
  surfaces_[0].move(nodes_a, tree);
  surfaces_[1].move(nodes_b, tree);
  const double step = (surfaces_[0].stretch() + surfaces_[1].stretch() +
                       (surfaces_[0].shift() - surfaces_[1].shift()).norm()) *
                      (1.0 + kRounding);
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
    searches_[1 - side]->begin(both.center(), surfaces_[side].bound());
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
  for (LaneSearch* search : {searches_[0].get(), searches_[1].get()}) search->begin(both.center(), both);
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

/// Updates the feet of some springs, given in ascending order, in packets of points of one cluster.
void SkinContact::follow_packets(const std::vector<std::size_t>& springs) {
  const auto cluster = [&](std::size_t i) {
    const Spring& s = springs_[i];
    return std::pair(s.side, points(s.side)[static_cast<std::size_t>(s.point)].face / kClusterFaces);
  };
  for (std::size_t begin = 0, end = 0; begin < springs.size(); begin = end) {
    while (end < springs.size() && end - begin < kPacket && cluster(springs[end]) == cluster(springs[begin]))
      ++end;
    follow_packet({springs.data() + begin, end - begin});
  }
}

/// Updates the feet of one packet. @param springs  springs with points in one cluster, at most kPacket
void SkinContact::follow_packet(std::span<const std::size_t> springs) {
  const int side = springs_[springs.front()].side;
  const Surface& other = surfaces_[1 - side];
  LaneSearch& search = *searches_[1 - side];
  Packet packet;
  int faces[kPacket];
  int used = 0;
  for (const std::size_t i : springs) {
    search.set_point(packet, used, position(springs_[i]));
    faces[used++] = springs_[i].face;
  }
  search.finish(packet, used);
  const int own =
      points(side)[static_cast<std::size_t>(springs_[springs.front()].point)].face / kClusterFaces;
  if (own_)
    for (int& face : std::span(faces, static_cast<std::size_t>(used)))
      if (!own_->neighbours.may_touch(own, face / kClusterFaces)) face = -1;
  search.start(packet, faces, used);
  search.search(&packet, 1, neighbours(), own);
  for (int lane = 0; lane < used; ++lane) {
    Spring& spring = springs_[springs[static_cast<std::size_t>(lane)]];
    const int face = packet.face[lane] < 0 ? spring.face : packet.face[lane];
    const Vec3 x = position(spring);
    const Foot foot = other.nearest_around(x, face);
    if (own_ && !own_->neighbours.may_touch(own, foot.face / kClusterFaces)) {
      set_foot(spring, {face, other.nearest_on_face(face, x)}, false);
      spring.clear = 0.0;
      continue;
    }
    const bool is_inside = other.is_inside(foot);
    const ContactPoint& point = points(side)[static_cast<std::size_t>(spring.point)];
    set_foot(spring, foot, is_inside && overlaps(point, x, foot));
    if (is_inside) spring.clear = 0.0;
  }
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
  return std::sqrt(least2) * (1.0 - kRounding);
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
  int last = 0;
  for (std::size_t c = 0; c < where.size(); ++c) {
    if (where[c] == SideOfSurface::kOutside) continue;
    int& start = starts_[side][c];
    start = last = find_cluster(side, static_cast<int>(c), start < 0 ? last : start, near);
  }
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

/// Adds the springs of one cluster's points. @param start  initial guess of a near face
/// @return a face near the cluster
int SkinContact::find_cluster(int side, int cluster, int start, double near) {
  const Surface& other = surfaces_[1 - side];
  LaneSearch& search = *searches_[1 - side];
  const auto c = static_cast<std::size_t>(cluster);
  const int begin = cluster_points_[side][c], end = cluster_points_[side][c + 1];
  std::vector<Packet>& packets = scratch_->packets;
  std::vector<int>& open = scratch_->open;
  open.clear();
  for (int p = 0; begin + kPacket * p < end; ++p) {
    if (packets_clear_[side][static_cast<std::size_t>(first_packet_[side][c] + p)] > travelled_ + near)
      continue;
    Packet& packet = packets[open.size()];
    open.push_back(p);
    const int used = std::min(kPacket, end - begin - kPacket * p);
    for (int lane = 0; lane < used; ++lane)
      search.set_point(packet, lane,
                       position(side, points(side)[static_cast<std::size_t>(begin + kPacket * p + lane)]));
    search.finish(packet, used, own_ ? own_->depth() : LaneSearch::kAnywhere);
    int faces[kPacket + 1] = {start};
    const auto& feet = feet_[side][static_cast<std::size_t>(first_packet_[side][c] + p)];
    std::copy(feet.begin(), feet.end(), faces + 1);
    search.start(packet, faces, kPacket + 1);
  }
  if (!open.empty()) search.search(packets.data(), static_cast<int>(open.size()), neighbours(), cluster);
  for (std::size_t o = 0; o < open.size(); ++o) {
    const Packet& packet = packets[o];
    const int p = open[o];
    const auto place = static_cast<std::size_t>(first_packet_[side][c] + p);
    keep_faces(packet, feet_[side][place]);
    double least = std::numeric_limits<double>::infinity();  // Smallest distance of the outside points.
    for (int lane = 0; lane < std::min(kPacket, end - begin - kPacket * p); ++lane) {
      const double distance = std::sqrt(static_cast<double>(packet.distance2[lane])) - 2.0 * search.slack();
      const bool is_in_front = packet.height[lane] > search.slack();  // Height above the plane of its face.
      if (packet.face[lane] < 0 || (is_in_front && distance >= near)) {
        least = std::min(least, packet.face[lane] < 0 ? 0.0 : distance);
        continue;
      }
      const int number = begin + kPacket * p + lane;
      const ContactPoint& point = points(side)[static_cast<std::size_t>(number)];
      const Vec3 x = position(side, point);
      const Foot foot = other.nearest_around(x, packet.face[lane]);
      const bool is_of_neighbour = own_ && !own_->neighbours.may_touch(cluster, foot.face / kClusterFaces);
      const bool is_inside = !is_of_neighbour && other.is_inside(foot);
      const bool is_overlap = is_inside && overlaps(point, x, foot);
      const double away = is_of_neighbour ? distance : std::sqrt(foot.at.distance2);
      const bool is_outside = !is_inside && !is_of_neighbour;
      least = std::min(least, is_outside ? away : 0.0);
      if (is_overlap || (is_outside && away < near && may_come_near(point, foot)))
        add_spring(side, number, foot, is_overlap);
    }
    packets_clear_[side][place] = least > 0.0 ? travelled_ + least * (1.0 - kRounding) : -1.0;
  }
  clear_[side][c] = std::numeric_limits<double>::infinity();  // A cluster may have no points.
  for (int p = first_packet_[side][c]; p < first_packet_[side][c + 1]; ++p)
    clear_[side][c] = std::min(clear_[side][c], packets_clear_[side][static_cast<std::size_t>(p)]);
  return open.empty() || packets[0].face[0] < 0 ? start : packets[0].face[0];
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
    if (std::sqrt(middle.at.distance2) > (radius + most_lowered_[side]) * (1.0 + kRounding) &&
        !other.is_inside(middle))
      continue;
    int start = middle.face;
    const auto cluster = static_cast<std::size_t>(node.begin);
    for (int p = cluster_points_[side][cluster]; p < cluster_points_[side][cluster + 1]; ++p) {
      const Foot foot = other.nearest(position(side, points(side)[static_cast<std::size_t>(p)]), start);
      start = foot.face;
      const bool is_inside = other.is_inside(foot);
      if (is_inside || std::sqrt(foot.at.distance2) < most_lowered_[side])
        add_spring(side, p, foot, is_inside);
    }
  }
}

}  // namespace palpate::distance
