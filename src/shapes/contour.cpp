#include "contour.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "palpate/core/error.h"
#include "remesh.h"

namespace palpate::shapes {
namespace {

/// Joins half a body and its mirror image about x = 0 along the rim; both sides are bitwise equal.
TriMesh with_mirror_image(const TriMesh& half) {
  const int n = static_cast<int>(half.vertices.cols()), faces = static_cast<int>(half.faces.cols());
  std::vector<int> image(static_cast<std::size_t>(n));
  int next = n;
  for (int v = 0; v < n; ++v) image[static_cast<std::size_t>(v)] = half.vertices(0, v) == 0.0 ? v : next++;
  TriMesh whole;
  whole.vertices.resize(3, next);
  whole.vertices.leftCols(n) = half.vertices;
  for (int v = 0; v < n; ++v)
    if (image[static_cast<std::size_t>(v)] >= n)
      whole.vertices.col(image[static_cast<std::size_t>(v)]) =
          Vec3(-half.vertices(0, v), half.vertices(1, v), half.vertices(2, v));
  whole.faces.resize(3, 2 * faces);
  whole.faces.leftCols(faces) = half.faces;
  for (int f = 0; f < faces; ++f)
    for (int k = 0; k < 3; ++k)
      whole.faces(k, faces + f) = image[static_cast<std::size_t>(half.faces(2 - k, f))];
  return whole;
}

/// Returns the piece with the most faces; specks of relief outside the body and bubbles in it are dropped.
TriMesh largest_piece(const TriMesh& mesh) {
  std::vector<int> parent(static_cast<std::size_t>(mesh.vertices.cols()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f)
    for (int k = 1; k < 3; ++k) parent[root(mesh.faces(k, f))] = root(mesh.faces(0, f));
  std::vector<int> faces(parent.size(), 0);
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) ++faces[root(mesh.faces(0, f))];
  const int chosen = static_cast<int>(std::max_element(faces.begin(), faces.end()) - faces.begin());
  TriMesh out;
  std::vector<int> number(parent.size(), -1);
  int vertices = 0;
  out.vertices.resize(3, mesh.vertices.cols());
  for (int v = 0; v < static_cast<int>(parent.size()); ++v)
    if (root(v) == chosen) out.vertices.col(number[v] = vertices++) = mesh.vertices.col(v);
  out.vertices.conservativeResize(3, vertices);
  out.faces.resize(3, faces[chosen]);
  int kept = 0;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f)
    if (root(mesh.faces(0, f)) == chosen) {
      for (int k = 0; k < 3; ++k) out.faces(k, kept) = number[mesh.faces(k, f)];
      ++kept;
    }
  return out;
}

}  // namespace

// Halving the edges of a first contour more than twice leaves needles where its triangles were badly shaped,
// so a coarser lattice is refined first.
constexpr double kCoarsest = 3.0;  ///< spacing of the lattice in target edges

TriMesh contour(const Blueprint& blueprint, int vertices) {
  RemeshRules rules;
  rules.inside = blueprint.inside;
  rules.size = blueprint.size;
  rules.rims_in_plane = blueprint.symmetric;
  rules.probe = 1e-3 * blueprint.lattice;
  Remesher remesher(largest_piece(march(blueprint)), rules);
  double edge = remesher.edge_for(vertices);
  if (blueprint.lattice > kCoarsest * edge) {
    Blueprint finer = blueprint;
    finer.lattice = kCoarsest * edge;
    return contour(finer, vertices);
  }
  for (int i = 0; i < 3; ++i) remesher.round(edge);
  edge *= std::sqrt(static_cast<double>(remesher.count()) / vertices);  // the number scales as edge^-2
  for (int i = 0; i < 3; ++i) remesher.round(edge);
  remesher.trim(edge, vertices);
  remesher.settle(2);
  const TriMesh mesh = remesher.result();
  return blueprint.symmetric ? with_mirror_image(mesh) : mesh;
}

}  // namespace palpate::shapes
