#include "proxy/skin_clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "palpate/mesh/embedding.h"

namespace palpate::proxy {
namespace {

using Features = Eigen::Matrix<double, 6, Eigen::Dynamic>;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// Returns the number of clusters per group: one each, and the remaining ones by area (largest remainders
/// first; of equals the first group).
std::vector<int> share_out(const VecX& area, int count) {
  const int groups = static_cast<int>(area.size()), rest = std::max(0, count - groups);
  std::vector<int> shares(static_cast<std::size_t>(groups), 1), order(static_cast<std::size_t>(groups));
  VecX remainder(groups);
  int given = 0;
  for (int g = 0; g < groups; ++g) {
    const double exact = rest * area[g] / area.sum();
    shares[static_cast<std::size_t>(g)] += static_cast<int>(std::floor(exact));
    given += static_cast<int>(std::floor(exact));
    remainder[g] = exact - std::floor(exact);
  }
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return remainder[a] > remainder[b]; });
  for (int i = 0; i < groups && given < rest; ++i, ++given)
    ++shares[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])];
  return shares;
}

/// Lloyd's k-means, weighted by area.  Deterministic farthest-point start (Gonzalez 1985): each centre is the
/// point farthest from the previous ones, the first the point farthest from the mean.  Ties go to the first.
std::vector<int> k_means(const Features& x, const VecX& weight, int count) {
  constexpr int kMaxRounds = 25;
  const Eigen::Index n = x.cols();
  count = static_cast<int>(std::min<Eigen::Index>(count, n));
  Features centre(6, count);
  const Eigen::Matrix<double, 6, 1> middle = x * weight / weight.sum();
  VecX nearest = (x.colwise() - middle).colwise().squaredNorm();
  for (int c = 0; c < count; ++c) {
    Eigen::Index farthest = 0;
    nearest.maxCoeff(&farthest);
    centre.col(c) = x.col(farthest);
    const VecX distance = (x.colwise() - centre.col(c)).colwise().squaredNorm();
    nearest = c == 0 ? distance : VecX(nearest.cwiseMin(distance));
  }
  std::vector<int> cluster(static_cast<std::size_t>(n), -1);
  for (int round = 0; round < kMaxRounds; ++round) {
    bool changed = false;
    for (Eigen::Index i = 0; i < n; ++i) {
      int best = 0;
      double least = kFar;
      for (int c = 0; c < count; ++c) {
        const double distance = (x.col(i) - centre.col(c)).squaredNorm();
        if (distance < least) {
          least = distance;
          best = c;
        }
      }
      changed |= cluster[static_cast<std::size_t>(i)] != best;
      cluster[static_cast<std::size_t>(i)] = best;
    }
    if (!changed) break;
    Features sum = Features::Zero(6, count);
    VecX total = VecX::Zero(count);
    for (Eigen::Index i = 0; i < n; ++i) {
      sum.col(cluster[static_cast<std::size_t>(i)]) += weight[i] * x.col(i);
      total[cluster[static_cast<std::size_t>(i)]] += weight[i];
    }
    for (int c = 0; c < count; ++c)
      if (total[c] > 0.0) centre.col(c) = sum.col(c) / total[c];
  }
  return cluster;
}

}  // namespace

// The distance to a capsule with end radii r0 and r1 is taken as |x - (head + s (tail - head))| - (r0 + s (r1
// - r0)) at the nearest s in [0, 1] on the axis.
std::vector<int> nearest_bone(const Skeleton& skeleton, const Points& points) {
  std::vector<int> out(static_cast<std::size_t>(points.cols()), 0);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    double least = kFar;
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
      const Bone& bone = skeleton.bones[b];
      const Vec3 axis = bone.tail - bone.head, arm = points.col(i) - bone.head;
      const double length2 = axis.squaredNorm(),
                   s = length2 > 0.0 ? std::clamp(arm.dot(axis) / length2, 0.0, 1.0) : 0.0;
      const double distance =
          (arm - s * axis).norm() - bone.head_radius - s * (bone.tail_radius - bone.head_radius);
      if (distance < least) {
        least = distance;
        out[static_cast<std::size_t>(i)] = static_cast<int>(b);
      }
    }
  }
  return out;
}

// Positions are scaled by the edge of a cluster's share of the area, L = sqrt(area / count); normals so that
// opposite ones are normal_weight apart.
std::vector<int> skin_clusters(const TriMesh& skin, const std::vector<int>& group_of_vertex, int count,
                               double normal_weight) {
  const int groups = 1 + *std::max_element(group_of_vertex.begin(), group_of_vertex.end());
  Points normals;
  VecX areas;
  mesh::vertex_normals_and_areas(skin.faces, skin.vertices, normals, areas);
  areas.array() += 1e-12 * areas.sum();  // small weight for vertices of degenerate faces
  const double length = std::sqrt(areas.sum() / std::max(1, count));

  std::vector<std::vector<int>> vertices(static_cast<std::size_t>(groups));
  for (std::size_t v = 0; v < group_of_vertex.size(); ++v)
    vertices[static_cast<std::size_t>(group_of_vertex[v])].push_back(static_cast<int>(v));
  std::erase_if(vertices, [](const std::vector<int>& group) { return group.empty(); });
  VecX group_area(static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t g = 0; g < vertices.size(); ++g)
    group_area[static_cast<Eigen::Index>(g)] = areas(vertices[g]).sum();
  const std::vector<int> shares = share_out(group_area, count);

  std::vector<int> out(group_of_vertex.size(), -1);
  int next = 0;
  for (std::size_t g = 0; g < vertices.size(); ++g) {
    Features x(6, static_cast<Eigen::Index>(vertices[g].size()));
    x.topRows<3>() = skin.vertices(Eigen::all, vertices[g]) / length;
    x.bottomRows<3>() = 0.5 * normal_weight * normals(Eigen::all, vertices[g]);
    const std::vector<int> cluster = k_means(x, areas(vertices[g]), shares[g]);
    // Number the non-empty clusters in the order of their first vertices.
    std::vector<int> number(static_cast<std::size_t>(shares[g]), -1);
    for (std::size_t i = 0; i < cluster.size(); ++i) {
      int& own = number[static_cast<std::size_t>(cluster[i])];
      if (own < 0) own = next++;
      out[static_cast<std::size_t>(vertices[g][i])] = own;
    }
  }
  return out;
}

}  // namespace palpate::proxy
