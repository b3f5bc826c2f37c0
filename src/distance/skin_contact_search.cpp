// Loops of the search that threads share: over packets of springs, and over the clusters of one skin. Each
// thread writes to its packets and clusters alone, and springs are joined in the order of the clusters.
#include <algorithm>
#include <cmath>
#include <limits>

#include "distance/skin_contact_impl.h"
#include "palpate/core/workers.h"

namespace palpate::distance {
namespace {

/// Packets, clusters and springs per task: some ten microseconds.
constexpr int kPacketsInTask = 8, kClustersInTask = 4, kSpringsInTask = 64;

/// Collects the distinct faces of a packet, padded with -1.
template <std::size_t count>
void keep_faces(const Packet& packet, std::array<int, count>& faces) {
  std::size_t kept = 0;
  for (const int face : packet.face)
    if (std::find(faces.begin(), faces.begin() + kept, face) == faces.begin() + kept) faces[kept++] = face;
  std::fill(faces.begin() + kept, faces.end(), -1);
}

/// Calls work(first, last, worker) for consecutive ranges of [0, count).
template <class Work>
void share(int count, int in_task, Work&& work) {
  workers::for_each(
      (count + in_task - 1) / in_task,
      [&](int task, int worker) { work(in_task * task, std::min(count, in_task * (task + 1)), worker); },
      workers::Order::kFromBothEnds);
}

}  // namespace

/// Creates the searchers of all threads that share loops of the calling one.
void SkinContact::fit_searchers() {
  const auto count = own_ ? std::size_t{1} : static_cast<std::size_t>(workers::count());
  while (searchers_.size() < count) {
    if (searchers_.empty())
      searchers_.push_back(std::make_unique<Searcher>(surfaces_));
    else
      searchers_.push_back(std::make_unique<Searcher>(std::unique_ptr<Searcher::Copies>(
          new Searcher::Copies{{Surface(surfaces_[0].skin()), Surface(surfaces_[1].skin())}})));
    Searcher& added = *searchers_.back();
    added.packets.resize(most_packets_);
    added.open.reserve(most_packets_);
    added.found.reserve(std::max(points(0).size(), points(1).size()));
  }
}

Vec3 SkinContact::position(const Searcher& by, int side, int point) const {
  const ContactPoint& at = points(side)[static_cast<std::size_t>(point)];
  return by.surfaces[side].point(at.face, at.weights);
}

/// Starts the searches on one skin. @param origin, box  as LaneSearch::begin
void SkinContact::begin_search(int side, const Vec3& origin, const Eigen::AlignedBox3d& box) {
  Query& query = queries_[side];
  query = {origin, box, query.number + 1};
  searchers_.front()->searches[side].begin(origin, box);
}

/// Returns the searcher of a thread, in the current state.
SkinContact::Searcher& SkinContact::searcher(int worker) {
  Searcher& by = *searchers_[static_cast<std::size_t>(worker)];
  if (!by.copies) return by;
  if (by.moved != positions_.moved) {
    const auto tree = by.fitted == positions_.fitted ? Surface::Tree::kKeep : Surface::Tree::kFit;
    for (int side = 0; side < 2; ++side) by.surfaces[side].move(positions_.nodes[side], tree);
    by.moved = positions_.moved;
    by.fitted = positions_.fitted;
  }
  for (int side = 0; side < 2; ++side)
    if (by.begun[side] != queries_[side].number) {
      by.searches[side].begin(queries_[side].origin, queries_[side].box);
      by.begun[side] = queries_[side].number;
    }
  return by;
}

/// Updates the feet of some springs, given in ascending order, in packets of points of one cluster.
void SkinContact::follow_packets(const std::vector<std::size_t>& springs) {
  const auto cluster = [&](std::size_t i) {
    const Spring& s = springs_[i];
    return std::pair(s.side, points(s.side)[static_cast<std::size_t>(s.point)].face / kClusterFaces);
  };
  packets_.clear();
  for (std::size_t begin = 0, end = 0; begin < springs.size(); begin = end) {
    while (end < springs.size() && end - begin < kPacket && cluster(springs[end]) == cluster(springs[begin]))
      ++end;
    packets_.push_back({begin, end});
  }
  const workers::Count count(own_ ? 1 : workers::count());
  fit_searchers();
  share(static_cast<int>(packets_.size()), kPacketsInTask, [&](int first, int last, int worker) {
    Searcher& by = searcher(worker);
    for (int p = first; p < last; ++p) {
      const PacketRange& range = packets_[static_cast<std::size_t>(p)];
      follow_packet(by, {springs.data() + range.begin, range.end - range.begin});
    }
  });
}

/// Updates the feet of one packet.
/// @param springs  springs with points in one cluster, at most kPacket
void SkinContact::follow_packet(Searcher& by, std::span<const std::size_t> springs) {
  const int side = springs_[springs.front()].side;
  const Surface& other = by.surfaces[1 - side];
  LaneSearch& search = by.searches[1 - side];
  Packet packet;
  int faces[kPacket];
  int used = 0;
  for (const std::size_t i : springs) {
    search.set_point(packet, used, position(by, springs_[i].side, springs_[i].point));
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
    const Vec3 x = position(by, side, spring.point);
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

void SkinContact::visit_placed(void (*visit)(void* to, std::size_t i, const Vec3& x, const Vec3& out),
                               void* to) {
  const workers::Count count(own_ ? 1 : workers::count());
  fit_searchers();
  share(static_cast<int>(springs_.size()), kSpringsInTask, [&](int first, int last, int worker) {
    const Searcher& by = searcher(worker);
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      const Spring& s = springs_[i];
      if (s.is_placed) visit(to, i, position(by, s.side, s.point), outward(by.surfaces[1 - s.side], s));
    }
  });
}

/// Adds the springs of all clusters of a side that may be near the other skin or inside it.
void SkinContact::search_clusters(int side, double near) {
  cluster_searches_.clear();
  const std::vector<SideOfSurface>& where = where_[side];
  int guess = 0;  // face near this cluster, or else near one before it, in an earlier query
  for (std::size_t c = 0; c < where.size(); ++c) {
    if (where[c] == SideOfSurface::kOutside) continue;
    if (const int start = starts_[side][c]; start >= 0) guess = start;
    cluster_searches_.push_back({static_cast<int>(c), guess, 0, 0, 0});
  }
  fit_searchers();
  for (const auto& by : searchers_) by->found.clear();
  share(static_cast<int>(cluster_searches_.size()), kClustersInTask, [&](int first, int last, int worker) {
    Searcher& by = searcher(worker);
    int before = cluster_searches_[static_cast<std::size_t>(first)].guess;
    for (int k = first; k < last; ++k) {
      ClusterSearch& search = cluster_searches_[static_cast<std::size_t>(k)];
      int& start = starts_[side][static_cast<std::size_t>(search.cluster)];
      search.worker = worker;
      search.begin = by.found.size();
      start = before = find_cluster(by, side, search.cluster, start < 0 ? before : start, near, by.found);
      search.end = by.found.size();
    }
  });
  for (const ClusterSearch& search : cluster_searches_) {
    const std::vector<Spring>& found = searchers_[static_cast<std::size_t>(search.worker)]->found;
    springs_.insert(springs_.end(), found.begin() + static_cast<std::ptrdiff_t>(search.begin),
                    found.begin() + static_cast<std::ptrdiff_t>(search.end));
  }
}

/// Adds the springs of one cluster's points to `out`.
/// @param start  initial guess of a near face
/// @return a face near the cluster
int SkinContact::find_cluster(Searcher& by, int side, int cluster, int start, double near,
                              std::vector<Spring>& out) {
  const Surface& other = by.surfaces[1 - side];
  LaneSearch& search = by.searches[1 - side];
  const auto c = static_cast<std::size_t>(cluster);
  const int begin = cluster_points_[side][c], end = cluster_points_[side][c + 1];
  std::vector<Packet>& packets = by.packets;
  std::vector<int>& open = by.open;
  open.clear();
  for (int p = 0; begin + kPacket * p < end; ++p) {
    if (packets_clear_[side][static_cast<std::size_t>(first_packet_[side][c] + p)] > travelled_ + near)
      continue;
    Packet& packet = packets[open.size()];
    open.push_back(p);
    const int used = std::min(kPacket, end - begin - kPacket * p);
    for (int lane = 0; lane < used; ++lane)
      search.set_point(packet, lane, position(by, side, begin + kPacket * p + lane));
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
      const Vec3 x = position(by, side, number);
      const Foot foot = other.nearest_around(x, packet.face[lane]);
      const bool is_of_neighbour = own_ && !own_->neighbours.may_touch(cluster, foot.face / kClusterFaces);
      const bool is_inside = !is_of_neighbour && other.is_inside(foot);
      const bool is_overlap = is_inside && overlaps(point, x, foot);
      const double away = is_of_neighbour ? distance : std::sqrt(foot.at.distance2);
      const bool is_outside = !is_inside && !is_of_neighbour;
      least = std::min(least, is_outside ? away : 0.0);
      if (is_overlap || (is_outside && away < near && may_come_near(point, foot)))
        add_spring(side, number, foot, is_overlap, out);
    }
    packets_clear_[side][place] = least > 0.0 ? travelled_ + least * (1.0 - kMarginOfBounds) : -1.0;
  }
  clear_[side][c] = std::numeric_limits<double>::infinity();  // A cluster may have no points.
  for (int p = first_packet_[side][c]; p < first_packet_[side][c + 1]; ++p)
    clear_[side][c] = std::min(clear_[side][c], packets_clear_[side][static_cast<std::size_t>(p)]);
  return open.empty() || packets[0].face[0] < 0 ? start : packets[0].face[0];
}

}  // namespace palpate::distance
