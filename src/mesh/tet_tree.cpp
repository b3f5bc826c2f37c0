#include "mesh/tet_tree.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "palpate/core/error.h"
#include "palpate/mesh/quality.h"

namespace palpate::mesh {
namespace {

/// Returns the distance from a point to a segment.
double segment_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 edge = b - a;
  const double length2 = edge.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp((p - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
  return (p - a - s * edge).norm();
}

// The foot of the perpendicular lies in the triangle if it is on the inner side of each edge; otherwise the
// nearest point is on an edge.
double triangle_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const bool above = n.dot((b - a).cross(p - a)) >= 0.0 && n.dot((c - b).cross(p - b)) >= 0.0 &&
                     n.dot((a - c).cross(p - c)) >= 0.0;
  if (above && n.squaredNorm() > 0.0) return std::abs(n.normalized().dot(p - a));
  return std::min({segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
}

}  // namespace

Eigen::Vector4d tet_weights(const TetMesh& mesh, int tet, const Vec3& point) {
  const auto node = [&](int k) -> Vec3 { return mesh.nodes.col(mesh.tets(k, tet)); };
  Mat3 edges;
  for (int k = 1; k < 4; ++k) edges.col(k - 1) = node(k) - node(0);
  const Vec3 w = edges.inverse() * (point - node(0));
  return {1.0 - w.sum(), w[0], w[1], w[2]};
}

double tet_distance(const TetMesh& mesh, int tet, const Vec3& point) {
  double nearest = 0.0;
  bool outside = false;
  for (const auto& face : kTetFaces) {
    const Vec3 a = mesh.nodes.col(mesh.tets(face[0], tet)), b = mesh.nodes.col(mesh.tets(face[1], tet)),
               c = mesh.nodes.col(mesh.tets(face[2], tet));
    // On the inner side of this face another face is nearer, or the point is inside.
    if ((b - a).cross(c - a).dot(point - a) <= 0.0) continue;
    const double distance = triangle_distance(point, a, b, c);
    nearest = outside ? std::min(nearest, distance) : distance;
    outside = true;
  }
  return nearest;
}

TetTree::TetTree(const TetMesh& mesh) : mesh_(mesh), order_(static_cast<std::size_t>(mesh.tets.cols())) {
  PALPATE_CHECK(!order_.empty(), "a tree of no tetrahedra");
  std::iota(order_.begin(), order_.end(), 0);
  boxes_.reserve(2 * order_.size());
  boxes_.emplace_back();
  build(0, 0, static_cast<int>(order_.size()));
}

void TetTree::build(std::size_t box, int first, int count) {
  constexpr int kLeaf = 4;
  const auto node = [&](int tet, int k) -> Vec3 { return mesh_.nodes.col(mesh_.tets(k, tet)); };
  const auto begin = order_.begin() + first, end = begin + count;
  Vec3 low = node(*begin, 0), high = low;
  for (auto t = begin; t != end; ++t)
    for (int k = 0; k < 4; ++k) {
      low = low.cwiseMin(node(*t, k));
      high = high.cwiseMax(node(*t, k));
    }
  boxes_[box] = {low, high, first, count};
  if (count <= kLeaf) return;
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const auto along = [&](int tet) {
    return node(tet, 0)[axis] + node(tet, 1)[axis] + node(tet, 2)[axis] + node(tet, 3)[axis];
  };
  std::nth_element(begin, begin + count / 2, end,
                   [&](int s, int t) { return std::pair(along(s), s) < std::pair(along(t), t); });
  const std::size_t children = boxes_.size();
  boxes_[box].first = static_cast<int>(children);
  boxes_[box].count = 0;
  boxes_.emplace_back();
  boxes_.emplace_back();
  build(children, first, count / 2);
  build(children + 1, first + count / 2, count - count / 2);
}

double TetTree::box_distance(const Box& box, const Vec3& point) const {
  return (box.low - point).cwiseMax(point - box.high).cwiseMax(0.0).norm();
}

double TetTree::nearest(const Vec3& point, double tolerance, int guess, std::vector<int>& tets) {
  candidates_.clear();
  double least = tet_distance(mesh_, guess, point);
  open_.assign(1, 0);
  while (!open_.empty()) {
    const Box& box = boxes_[static_cast<std::size_t>(open_.back())];
    open_.pop_back();
    if (box_distance(box, point) > least + tolerance) continue;
    if (box.count == 0) {
      const bool second_first = box_distance(boxes_[static_cast<std::size_t>(box.first)], point) >
                                box_distance(boxes_[static_cast<std::size_t>(box.first) + 1], point);
      open_.push_back(box.first + (second_first ? 0 : 1));
      open_.push_back(box.first + (second_first ? 1 : 0));
      continue;
    }
    for (int i = box.first; i < box.first + box.count; ++i) {
      const int tet = order_[static_cast<std::size_t>(i)];
      const double distance = tet_distance(mesh_, tet, point);
      least = std::min(least, distance);
      if (distance <= least + tolerance) candidates_.push_back({tet, distance});
    }
  }
  tets.clear();
  for (const Candidate& candidate : candidates_)
    if (candidate.distance <= least + tolerance) tets.push_back(candidate.tet);
  std::sort(tets.begin(), tets.end());
  return least;
}

}  // namespace palpate::mesh
