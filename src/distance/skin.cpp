#include "distance/skin.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "mesh/spatial_order.h"
#include "palpate/core/error.h"

namespace palpate::distance {
namespace {

/// Bisects faces across the longest side of their bounding box, at multiples of 32 and then of 16, 8 and 4
/// faces, so that all clusters except the last are full and their subsets are compact.
class Bisection {
 public:
  Bisection(const Points& centroids, std::vector<int>& order, std::vector<ClusterNode>& tree)
      : centroids_(centroids), order_(order), tree_(tree) {}

  void cut(int begin, int end) {
    const std::size_t here = tree_.size();
    tree_.push_back({begin / kClusterFaces, (end + kClusterFaces - 1) / kClusterFaces, 0});
    if (end - begin <= kClusterFaces) return cut_cluster(begin, end);
    const int middle = partition(begin, end, kClusterFaces);
    cut(begin, middle);
    tree_[here].right = static_cast<int>(tree_.size());
    cut(middle, end);
  }

 private:
  void cut_cluster(int begin, int end) {
    const int count = end - begin;
    if (count <= 4) return;
    const int middle = partition(begin, end, count > 16 ? 16 : count > 8 ? 8 : 4);
    cut_cluster(begin, middle);
    cut_cluster(middle, end);
  }
  int partition(int begin, int end, int unit) {
    const int units = std::max(1, (end - begin + unit) / (2 * unit));
    const int middle = begin + units * unit;
    mesh::cut_across_longest(centroids_, order_, begin, end, middle);
    return middle;
  }

  const Points& centroids_;
  std::vector<int>& order_;
  std::vector<ClusterNode>& tree_;
};

/// Returns the components of some faces that are connected by vertices, each in the order of `faces`.
std::vector<std::vector<int>> connected_parts(std::vector<int> faces, const Faces& corners) {
  const auto share_vertex = [&](int a, int b) {
    for (const int v : corners.col(a))
      if ((corners.col(b).array() == v).any()) return true;
    return false;
  };
  std::vector<std::vector<int>> parts;
  while (!faces.empty()) {
    std::vector<int> part{faces.front()}, rest(faces.begin() + 1, faces.end());
    for (std::size_t i = 0; i < part.size(); ++i) {
      const auto end =
          std::stable_partition(rest.begin(), rest.end(), [&](int f) { return !share_vertex(part[i], f); });
      part.insert(part.end(), end, rest.end());
      rest.erase(end, rest.end());
    }
    std::sort(part.begin(), part.end(), [&](int a, int b) {
      return std::find(faces.begin(), faces.end(), a) < std::find(faces.begin(), faces.end(), b);
    });
    parts.push_back(std::move(part));
    faces = std::move(rest);
  }
  return parts;
}

/// Splits each cluster into its connected components, one cluster per component.
class ConnectedClusters {
 public:
  ConnectedClusters(const Faces& corners, std::vector<int>& order, std::vector<ClusterNode>& tree)
      : corners_(corners),
        given_(std::exchange(order, {})),
        before_(std::exchange(tree, {})),
        order_(order),
        tree_(tree) {
    copy(0);
  }

 private:
  int clusters() const { return static_cast<int>(order_.size()) / kClusterFaces; }
  std::size_t open() {
    tree_.push_back({clusters(), 0, 0});
    return tree_.size() - 1;
  }
  void copy(std::size_t node) {
    const ClusterNode& of = before_[node];
    if (!of.right) {
      const auto begin = given_.begin() + kClusterFaces * of.begin;
      const auto count = std::min<std::ptrdiff_t>(kClusterFaces, given_.end() - begin);
      return add(connected_parts({begin, begin + count}, corners_), 0);
    }
    const std::size_t here = open();
    copy(node + 1);
    tree_[here].right = static_cast<int>(tree_.size());
    copy(static_cast<std::size_t>(of.right));
    tree_[here].end = clusters();
  }
  void add(const std::vector<std::vector<int>>& parts, std::size_t first) {
    const std::size_t here = open();
    if (first + 1 < parts.size()) {
      const std::size_t leaf = open();
      fill(parts[first]);
      tree_[leaf].end = clusters();
      tree_[here].right = static_cast<int>(tree_.size());
      add(parts, first + 1);
    } else {
      fill(parts[first]);
    }
    tree_[here].end = clusters();
  }
  void fill(const std::vector<int>& part) {
    order_.insert(order_.end(), part.begin(), part.end());
    order_.resize((order_.size() + kClusterFaces - 1) / kClusterFaces * kClusterFaces, part.back());
  }

  const Faces& corners_;
  const std::vector<int> given_;
  const std::vector<ClusterNode> before_;
  std::vector<int>& order_;
  std::vector<ClusterNode>& tree_;
};

bool is_repetition(const Skin& skin, int face) {
  const auto f = static_cast<std::size_t>(face);
  return f > 0 && skin.given_face[f] == skin.given_face[f - 1];
}

void join_across_edges(Skin& skin) {
  std::map<std::pair<int, int>, int> half_edges;  // From, to -> 3 face + opposite corner.
  for (int f = 0; f < skin.face_count(); ++f)
    for (int k = 0; k < 3 && !is_repetition(skin, f); ++k) {
      const int from = skin.faces((k + 1) % 3, f), to = skin.faces((k + 2) % 3, f);
      if (!half_edges.try_emplace({from, to}, 3 * f + k).second)
        fail(
            "contact needs a closed skin: the edge from vertex {} to vertex {} occurs twice in the same "
            "direction",
            from, to);
    }
  skin.across.resize(3, skin.face_count());
  for (const auto& [edge, at] : half_edges) {
    const auto other = half_edges.find({edge.second, edge.first});
    if (other == half_edges.end())
      fail("contact needs a closed skin: the edge from vertex {} to vertex {} has a face on one side only",
           edge.first, edge.second);
    skin.across(at % 3, at / 3) = other->second / 3;
  }
  for (int f = 1; f < skin.face_count(); ++f)
    if (is_repetition(skin, f)) skin.across.col(f) = skin.across.col(f - 1);
}

void collect_fans(Skin& skin) {
  std::vector<std::vector<int>> fans(static_cast<std::size_t>(skin.vertex_count()));
  for (int f = 0; f < skin.face_count(); ++f)
    for (int k = 0; k < 3 && !is_repetition(skin, f); ++k)
      fans[static_cast<std::size_t>(skin.faces(k, f))].push_back(f);
  skin.fan_begin = {0};
  for (const std::vector<int>& fan : fans) {
    skin.fan.insert(skin.fan.end(), fan.begin(), fan.end());
    skin.fan_begin.push_back(static_cast<int>(skin.fan.size()));
  }
}

void collect_cluster_vertices(Skin& skin) {
  skin.cluster_begin = {0};
  for (int c = 0; c < skin.cluster_count(); ++c) {
    const int begin = kClusterFaces * c, count = std::min(kClusterFaces, skin.face_count() - begin);
    std::vector<int> list(skin.faces.middleCols(begin, count).data(),
                          skin.faces.middleCols(begin, count).data() + 3 * count);
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    skin.cluster_vertices.insert(skin.cluster_vertices.end(), list.begin(), list.end());
    skin.cluster_begin.push_back(static_cast<int>(skin.cluster_vertices.size()));
  }
}

void join_clusters(Skin& skin) {
  std::vector<std::vector<int>> joined(static_cast<std::size_t>(skin.cluster_count()));
  for (std::size_t v = 0; v + 1 < skin.fan_begin.size(); ++v)
    for (int i = skin.fan_begin[v]; i < skin.fan_begin[v + 1]; ++i)
      for (int k = skin.fan_begin[v]; k < skin.fan_begin[v + 1]; ++k) {
        const int a = skin.fan[static_cast<std::size_t>(i)] / kClusterFaces,
                  b = skin.fan[static_cast<std::size_t>(k)] / kClusterFaces;
        if (a != b) joined[static_cast<std::size_t>(a)].push_back(b);
      }
  skin.joined_begin = {0};
  for (std::vector<int>& list : joined) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    skin.joined.insert(skin.joined.end(), list.begin(), list.end());
    skin.joined_begin.push_back(static_cast<int>(skin.joined.size()));
  }
}

/// Separates the tenth of the vertices with the largest sums of |weights|.
void set_aside_far(Skin& skin) {
  const VecX sum = skin.weights.cwiseAbs().colwise().sum().transpose();
  std::vector<int> order(static_cast<std::size_t>(skin.vertex_count()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return sum[a] > sum[b]; });
  skin.weight_sum = sum[order[order.size() / 10]];
  order.resize(order.size() / 10);
  while (!order.empty() && sum[order.back()] <= skin.weight_sum) order.pop_back();
  std::sort(order.begin(), order.end());
  skin.far_nodes = skin.nodes(Eigen::all, order);
  skin.far_weights = skin.weights(Eigen::all, order);
}

Skin build(const TriMesh& rest, NodeIndices nodes, NodeWeights weights, int node_count,
           Clusters clusters = Clusters::kAny) {
  if (!rest.vertices.allFinite() || !weights.allFinite())
    fail("contact needs a skin with finite positions and weights");
  Skin skin;
  skin.node_count = node_count;
  skin.nodes = std::move(nodes);
  skin.weights = std::move(weights);
  const Eigen::Index count = rest.faces.cols();
  Points centroids(3, count);
  for (Eigen::Index f = 0; f < count; ++f)
    centroids.col(f) = rest.vertices(Eigen::all, rest.faces.col(f)).rowwise().mean();
  skin.given_face.resize(static_cast<std::size_t>(count));
  std::iota(skin.given_face.begin(), skin.given_face.end(), 0);
  Bisection(centroids, skin.given_face, skin.tree).cut(0, static_cast<int>(count));
  if (clusters == Clusters::kConnected) ConnectedClusters(rest.faces, skin.given_face, skin.tree);
  skin.faces = rest.faces(Eigen::all, skin.given_face);
  skin.area.resize(skin.face_count());
  skin.longest_edge.resize(skin.face_count());
  for (int f = 0; f < skin.face_count(); ++f) {
    const Vec3 a = rest.vertices.col(skin.faces(0, f)), b = rest.vertices.col(skin.faces(1, f)),
               c = rest.vertices.col(skin.faces(2, f));
    skin.area[f] = 0.5 * (b - a).cross(c - a).norm();
    skin.longest_edge[f] = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    if (!(skin.area[f] > 0.0))
      fail("contact needs a skin without flat triangles: face {} has no area",
           skin.given_face[static_cast<std::size_t>(f)]);
    if (is_repetition(skin, f)) skin.area[f] = 0.0;
  }
  join_across_edges(skin);
  collect_fans(skin);
  collect_cluster_vertices(skin);
  join_clusters(skin);
  set_aside_far(skin);
  return skin;
}

}  // namespace

Skin make_skin(const TriMesh& rest, const mesh::Embedding& embedding, const Tets& tets, int node_count,
               Clusters clusters) {
  return build(rest, tets(Eigen::all, embedding.tet), embedding.weights, node_count, clusters);
}

Skin make_skin(const TriMesh& rest, Clusters clusters) {
  const Eigen::Index count = rest.vertices.cols();
  NodeIndices nodes(4, count);
  for (int i = 0; i < count; ++i) nodes.col(i).setConstant(i);
  NodeWeights weights = NodeWeights::Zero(4, count);
  weights.row(0).setOnes();
  return build(rest, std::move(nodes), std::move(weights), static_cast<int>(count), clusters);
}

// The simplex x, y, z >= low, sum of (x - low)/(3 size) <= 1 contains the bounding box: all weights lie in
// [0, 1].
Skin make_rigid_skin(const TriMesh& rest, Points& corners) {
  const Vec3 low = rest.vertices.rowwise().minCoeff(), size = rest.vertices.rowwise().maxCoeff() - low;
  if (!(size.array() > 0.0).all())
    fail("contact needs a surface that encloses a volume, but its bounding box is flat");
  corners.resize(3, 4);
  corners.colwise() = low;
  for (int k = 0; k < 3; ++k) corners(k, k + 1) += 3.0 * size[k];
  const Eigen::Index count = rest.vertices.cols();
  NodeIndices nodes(4, count);
  nodes.colwise() = Eigen::Vector4i(0, 1, 2, 3);
  NodeWeights weights(4, count);
  weights.bottomRows<3>() = (rest.vertices.colwise() - low).array().colwise() / (3.0 * size).array();
  weights.row(0) = 1.0 - weights.bottomRows<3>().colwise().sum().array();
  return build(rest, std::move(nodes), std::move(weights), 4);
}

}  // namespace palpate::distance
