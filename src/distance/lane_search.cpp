#include "distance/lane_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::distance {
namespace {

int aligned_start(const std::vector<float>& v) {
  return static_cast<int>((64 - reinterpret_cast<std::uintptr_t>(v.data()) % 64) % 64 / sizeof(float));
}

}  // namespace

LaneSearch::LaneSearch(const Surface& surface) : surface_(surface), kernels_(best_search_kernels()) {
  const auto count = static_cast<std::size_t>(surface.skin().cluster_count());
  planes_.resize(count * kPlaneFloats + kLanes);
  prepared_.assign(count, 0);
  clusters_.resize(count);
  const std::size_t stride = (count + kLanes - 1) / kLanes * kLanes;
  boxes_.resize(6 * stride + kLanes);
  targets_.planes = planes_.data() + aligned_start(planes_);
  targets_.clusters = clusters_.data();
  targets_.boxes = boxes_.data() + aligned_start(boxes_);
  targets_.box_stride = static_cast<int>(stride);
}

// A coordinate relative to the origin is rounded by half a unit in the last place, a plane's normal by a few
// units, and a height is a sum of four products: 32 units of the largest coordinate bound the error.
void LaneSearch::begin(const Vec3& origin, const Eigen::AlignedBox3d& box) {
  ++query_;
  tested_ = 0;
  origin_ = origin;
  const Eigen::AlignedBox3d all = box.merged(surface_.bound());
  const double size = std::max((all.max() - origin).maxCoeff(), (origin - all.min()).maxCoeff());
  slack_ = 32.0 * std::numeric_limits<float>::epsilon() * size;
  targets_.slack2 = static_cast<float>(slack_ * slack_);
}

void LaneSearch::set_point(Packet& packet, int lane, const Vec3& x) const {
  for (int d = 0; d < 3; ++d) packet.x[d][lane] = static_cast<float>(x[d] - origin_[d]);
}

void LaneSearch::finish(Packet& packet, int used, double within) const {
  for (int lane = 0; lane < kLanes; ++lane) {
    packet.distance2[lane] = static_cast<float>(within * within);
    packet.height[lane] = 0.0f;
    packet.face[lane] = -1;
    for (int d = 0; d < 3 && lane >= used; ++d) packet.x[d][lane] = packet.x[d][used - 1];
  }
}

void LaneSearch::prepare(int cluster) {
  const auto c = static_cast<std::size_t>(cluster);
  if (prepared_[c] == query_) return;
  prepared_[c] = query_;
  surface_.place(cluster);
  const int begin = kClusterFaces * cluster;
  kernels_.planes(surface_.vertices(), surface_.skin().faces.data() + 3 * begin,
                  std::min(kClusterFaces, surface_.skin().face_count() - begin), origin_.data(),
                  planes_.data() + aligned_start(planes_) + c * kPlaneFloats);
}

void LaneSearch::start(Packet& packet, const int* faces, int count) {
  int list[kLanes + 1];
  targets_.face_count = 0;
  for (int i = 0; i < count; ++i) {
    if (faces[i] < 0) continue;
    prepare(faces[i] / kClusterFaces);
    list[targets_.face_count++] = faces[i];
  }
  targets_.faces = list;
  targets_.cluster_count = 0;
  tested_ += kernels_.search(packet, targets_);
}

/// Collects the clusters that are within the packets' bounds of the box around their points.
void LaneSearch::collect(const Packet* packets, int count, const OwnNeighbourhood* neighbours, int own) {
  Eigen::AlignedBox3f points;
  float bound2 = 0.0f;
  for (int p = 0; p < count; ++p)
    for (int lane = 0; lane < kLanes; ++lane) {
      points.extend(Eigen::Vector3f(packets[p].x[0][lane], packets[p].x[1][lane], packets[p].x[2][lane]));
      bound2 = std::max(bound2, packets[p].distance2[lane]);
    }
  const double reach = std::sqrt(static_cast<double>(bound2)) * (1.0 + 1e-6) + 2.0 * slack_;
  Eigen::AlignedBox3d box(points.min().cast<double>() + origin_, points.max().cast<double>() + origin_);
  const std::vector<ClusterNode>& tree = surface_.skin().tree;
  float* rows = boxes_.data() + aligned_start(boxes_);
  int open[64], depth = 0;
  open[depth++] = 0;
  targets_.cluster_count = 0;
  while (depth > 0) {
    const int i = open[--depth];
    if (surface_.box(i).squaredExteriorDistance(box) > reach * reach) continue;
    const ClusterNode& node = tree[static_cast<std::size_t>(i)];
    if (node.right) {
      open[depth++] = node.right;
      open[depth++] = i + 1;
      continue;
    }
    if (neighbours && !neighbours->may_touch(own, node.begin)) continue;
    surface_.place(node.begin);
    if (surface_.box(i).squaredExteriorDistance(box) > reach * reach) continue;
    prepare(node.begin);
    const int at = targets_.cluster_count++;
    clusters_[static_cast<std::size_t>(at)] = node.begin;
    for (int d = 0; d < 3; ++d) {
      rows[d * targets_.box_stride + at] = static_cast<float>(surface_.box(i).min()[d] - origin_[d]);
      rows[(3 + d) * targets_.box_stride + at] = static_cast<float>(surface_.box(i).max()[d] - origin_[d]);
    }
  }
}

void LaneSearch::search(Packet* packets, int count, const OwnNeighbourhood* neighbours, int cluster) {
  collect(packets, count, neighbours, cluster);
  targets_.face_count = 0;
  for (int p = 0; p < count; ++p) tested_ += kernels_.search(packets[p], targets_);
}

}  // namespace palpate::distance
