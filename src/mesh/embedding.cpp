#include "palpate/mesh/embedding.h"

#include "mesh/tet_tree.h"
#include "palpate/core/error.h"

namespace palpate::mesh {
namespace {

/// Tie tolerance for distances [mesh sizes] and weight sums, so that rounding does not decide.
constexpr double kTie = 1e-9;

/// Returns the tetrahedron with the least sum |w| among equally near ones; the first of equals.
int least_extrapolating(const TetMesh& mesh, const std::vector<int>& tets, const Vec3& point,
                        Eigen::Vector4d& weights) {
  int best = -1;
  double least = 0.0;
  for (const int tet : tets) {
    const Eigen::Vector4d w = tet_weights(mesh, tet, point);
    const double sum = w.cwiseAbs().sum();
    if (best >= 0 && !(sum < least - kTie)) continue;
    best = tet;
    least = sum;
    weights = w;
  }
  return best;
}

/// Above this sum |w| the nearest tetrahedron extrapolates poorly (a flat one, along its thin direction), and
/// others at nearly that distance are considered.
constexpr double kPoor = 3.0;
constexpr double kNearly = 0.25;  ///< [distances of the nearest]
constexpr double kBetter = 0.9;   ///< largest ratio of the sums at which a farther tetrahedron is preferred

}  // namespace

Embedding embed(const TetMesh& mesh, const Points& points, EmbeddingReport* report) {
  if (mesh.tets.cols() == 0) fail("embedding {} points: there are no tetrahedra", points.cols());
  const double size = (mesh.nodes.rowwise().maxCoeff() - mesh.nodes.rowwise().minCoeff()).norm();
  TetTree tree(mesh);
  Embedding out;
  out.tet.resize(static_cast<std::size_t>(points.cols()));
  out.weights.resize(4, points.cols());
  EmbeddingReport found;
  std::vector<int> tets;
  int guess = 0;
  for (int i = 0; i < out.size(); ++i) {
    const Vec3 p = points.col(i);
    if (!p.allFinite()) fail("skin vertex {} at ({}, {}, {}) is not finite", i, p.x(), p.y(), p.z());
    const double distance = tree.nearest(p, kTie * size, guess, tets);
    Eigen::Vector4d weights = Eigen::Vector4d::Zero();
    guess = least_extrapolating(mesh, tets, p, weights);
    if (weights.cwiseAbs().sum() > kPoor) {
      tree.nearest(p, kNearly * distance, guess, tets);
      Eigen::Vector4d other = Eigen::Vector4d::Zero();
      const int nearly = least_extrapolating(mesh, tets, p, other);
      if (other.cwiseAbs().sum() < kBetter * weights.cwiseAbs().sum()) guess = nearly, weights = other;
    }
    out.tet[static_cast<std::size_t>(i)] = guess;
    out.weights.col(i) = weights;
    const double sum = weights.cwiseAbs().sum();
    if (!(sum <= kLargestWeightSum))
      fail(
          "skin vertex {} at ({:.6g}, {:.6g}, {:.6g}) m lies {:.3g} m outside the tetrahedra: its weights in "
          "the nearest one, {}, sum to {:.3g} in magnitude "
          "(at most {}); mesh the body closer to its skin, or with rounder elements",
          i, p.x(), p.y(), p.z(), distance, guess, sum, kLargestWeightSum);
    if (distance > kTie * size) {
      ++found.outside;
      if (distance > found.largest_distance) found.largest_distance = distance, found.farthest = i;
      if (sum > found.largest_weight_sum) found.largest_weight_sum = sum, found.most_extrapolated = i;
    }
  }
  if (report) *report = found;
  return out;
}

void evaluate(const Embedding& embedding, const Tets& tets, const Points& nodes, Points& points) {
  points.resize(3, embedding.size());
  for (int i = 0; i < embedding.size(); ++i) {
    const auto corner = tets.col(embedding.tet[static_cast<std::size_t>(i)]);
    const auto w = embedding.weights.col(i);
    points.col(i) = w[0] * nodes.col(corner[0]) + w[1] * nodes.col(corner[1]) + w[2] * nodes.col(corner[2]) +
                    w[3] * nodes.col(corner[3]);
  }
}

void add_to_nodes(const Embedding& embedding, const Tets& tets, const Points& point_forces,
                  Points& node_forces) {
  PALPATE_CHECK(point_forces.cols() == embedding.size(), "{} forces on {} embedded points",
                point_forces.cols(), embedding.size());
  for (int i = 0; i < embedding.size(); ++i)
    for (int k = 0; k < 4; ++k)
      node_forces.col(tets(k, embedding.tet[static_cast<std::size_t>(i)])) +=
          embedding.weights(k, i) * point_forces.col(i);
}

// Area vector of a face: (x1 - x0) x (x2 - x0) / 2, outward.
void vertex_area_vectors(const Faces& faces, const Points& vertices, Points& area_vectors) {
  area_vectors.setZero(3, vertices.cols());
  for (Eigen::Index f = 0; f < faces.cols(); ++f) {
    const Vec3 a = vertices.col(faces(0, f)),
               third = (vertices.col(faces(1, f)) - a).cross(vertices.col(faces(2, f)) - a) / 6.0;
    for (int k = 0; k < 3; ++k) area_vectors.col(faces(k, f)) += third;
  }
}

void vertex_normals_and_areas(const Faces& faces, const Points& vertices, Points& normals, VecX& areas) {
  normals.setZero(3, vertices.cols());
  areas.setZero(vertices.cols());
  for (Eigen::Index f = 0; f < faces.cols(); ++f) {
    const Vec3 a = vertices.col(faces(0, f)),
               third = (vertices.col(faces(1, f)) - a).cross(vertices.col(faces(2, f)) - a) / 6.0;
    const double area = third.norm();
    for (int k = 0; k < 3; ++k) {
      normals.col(faces(k, f)) += third;
      areas[faces(k, f)] += area;
    }
  }
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
    const double length = normals.col(v).norm();
    if (length > 1e-12 * areas[v])
      normals.col(v) /= length;
    else
      normals.col(v).setZero();
  }
}

}  // namespace palpate::mesh
