#include "distance/own_neighbourhood.h"

#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "distance/surface.h"
#include "palpate/core/error.h"

namespace palpate::distance {
namespace {

/// Returns a copy of the skin whose nodes are its vertices.
Skin of_vertices(const Skin& skin) {
  Skin out = skin;
  out.node_count = skin.vertex_count();
  for (int i = 0; i < skin.vertex_count(); ++i) {
    out.nodes.col(i).setConstant(i);
    out.weights.col(i) = Eigen::Vector4d::UnitX();
  }
  out.far_nodes.resize(4, 0);
  out.far_weights.resize(4, 0);
  out.weight_sum = 1.0;
  return out;
}

/// Clusters of a skin at rest, with their centres and extents.
class Clustered {
 public:
  Clustered(const Skin& skin, const Points& rest)
      : skin_(skin), by_vertices_(of_vertices(skin)), surface_(by_vertices_), way_(count(), kFar) {
    surface_.move(rest.data());
    for (std::size_t c = 0; c < count(); ++c) {
      const std::vector<int> vertices(skin.cluster_vertices.begin() + skin.cluster_begin[c],
                                      skin.cluster_vertices.begin() + skin.cluster_begin[c + 1]);
      vertices_.emplace_back(rest(Eigen::all, vertices));
      const Points& x = vertices_.back();
      centre_.emplace_back(0.5 * (x.rowwise().minCoeff() + x.rowwise().maxCoeff()));
      reach_.push_back((x.colwise() - centre_.back()).colwise().norm().maxCoeff());
    }
    most_ = *std::max_element(reach_.begin(), reach_.end());
  }
  std::size_t count() const { return static_cast<std::size_t>(skin_.cluster_count()); }

  /// Adds the clusters that are near `cluster` along the skin, including itself (Dijkstra's shortest paths).
  void along_skin(std::size_t cluster, double radius, std::vector<int>& out) {
    std::vector<std::size_t> seen{cluster};
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    way_[cluster] = 0.0;
    open.push({0.0, cluster});
    while (!open.empty()) {
      const auto [length, at] = open.top();
      open.pop();
      if (length > way_[at]) continue;
      for (int k = skin_.joined_begin[at]; k < skin_.joined_begin[at + 1]; ++k) {
        const auto next = static_cast<std::size_t>(skin_.joined[static_cast<std::size_t>(k)]);
        const double on = length + (centre_[next] - centre_[at]).norm();
        // Clusters that share a vertex are neighbours at any distance.
        if (at == cluster) out.push_back(static_cast<int>(next));
        if (on >= way_[next] || on > radius + reach_[cluster] + most_) continue;
        if (way_[next] == kFar) seen.push_back(next);
        way_[next] = on;
        open.push({on, next});
      }
    }
    for (const std::size_t c : seen) {
      if (way_[c] <= radius + reach_[cluster] + reach_[c]) out.push_back(static_cast<int>(c));
      way_[c] = kFar;
    }
  }

  /// Adds the clusters that are near `cluster` through tissue. @pre `out` is in ascending order
  void through_tissue(std::size_t cluster, double radius, std::vector<int>& out) const {
    const auto known = static_cast<std::ptrdiff_t>(out.size());
    std::vector<int> open{0};
    Eigen::AlignedBox3d box;
    for (const auto& x : vertices_[cluster].colwise()) box.extend(Vec3(x));
    while (!open.empty()) {
      const int i = open.back();
      open.pop_back();
      const ClusterNode& node = skin_.tree[static_cast<std::size_t>(i)];
      if (surface_.box(i).squaredExteriorDistance(box) > radius * radius) continue;
      if (node.right) {
        open.push_back(i + 1);
        open.push_back(node.right);
      } else if (!std::binary_search(out.begin(), out.begin() + known, node.begin) &&
                 is_tissue_between(cluster, static_cast<std::size_t>(node.begin), radius)) {
        out.push_back(node.begin);
      }
    }
  }

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();

  bool is_tissue_between(std::size_t a, std::size_t b, double radius) const {
    double least = radius * radius;
    Vec3 middle;
    bool is_near = false;
    for (const auto& x : vertices_[a].colwise()) {
      Eigen::Index nearest = 0;
      const double distance2 = (vertices_[b].colwise() - x).colwise().squaredNorm().minCoeff(&nearest);
      if (!(distance2 <= least)) continue;
      least = distance2;
      middle = 0.5 * (x + vertices_[b].col(nearest));
      is_near = true;
    }
    return is_near && surface_.is_inside(surface_.nearest(middle));
  }

  const Skin& skin_;
  Skin by_vertices_;
  Surface surface_;
  std::vector<Points> vertices_;
  std::vector<Vec3> centre_;
  std::vector<double> reach_;  ///< Distance from the centre to the farthest vertex, per cluster [m].
  double most_ = 0.0;          ///< Largest entry of reach_ [m].
  std::vector<double> way_;    ///< Path lengths of along_skin(); infinite between calls.
};

}  // namespace

OwnNeighbourhood::OwnNeighbourhood(const Skin& skin, const Points& rest, double radius) : radius_(radius) {
  if (!(radius > 0.0)) fail("self-contact of a skin: neighbourhood radius = {} m must be positive", radius);
  Clustered clusters(skin, rest);
  std::vector<std::vector<int>> of(clusters.count());
  for (std::size_t c = 0; c < of.size(); ++c) {
    clusters.along_skin(c, radius, of[c]);
    std::sort(of[c].begin(), of[c].end());
    clusters.through_tissue(c, radius, of[c]);
  }
  // Symmetrises the relation: ties between equally near vertices may have been broken differently for the two
  // clusters.
  const std::vector<std::vector<int>> found = of;
  for (std::size_t c = 0; c < of.size(); ++c)
    for (const int other : found[c]) of[static_cast<std::size_t>(other)].push_back(static_cast<int>(c));
  begin_ = {0};
  for (std::vector<int>& list : of) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    list_.insert(list_.end(), list.begin(), list.end());
    begin_.push_back(static_cast<int>(list_.size()));
  }
}

}  // namespace palpate::distance
