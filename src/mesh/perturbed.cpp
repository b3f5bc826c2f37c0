#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"
#include "palpate/mesh/quality.h"

namespace palpate::mesh {
namespace {

std::vector<double> shortest_edge_of_node(const TetMesh& mesh) {
  std::vector<double> out(static_cast<std::size_t>(mesh.nodes.cols()),
                          std::numeric_limits<double>::infinity());
  for (Eigen::Index t = 0; t < mesh.tets.cols(); ++t)
    for (const auto& [i, j] : kTetEdges) {
      const int a = mesh.tets(i, t), b = mesh.tets(j, t);
      const double edge = (mesh.nodes.col(a) - mesh.nodes.col(b)).norm();
      for (const int n : {a, b})
        out[static_cast<std::size_t>(n)] = std::min(out[static_cast<std::size_t>(n)], edge);
    }
  return out;
}

}  // namespace

TetMesh perturbed(TetMesh mesh, double amplitude, unsigned seed) {
  if (!(amplitude >= 0 && amplitude < 1))
    fail("perturbed mesh: amplitude = {} must lie in [0, 1)", amplitude);
  const auto edges = shortest_edge_of_node(mesh);
  std::vector<char> on_boundary(edges.size(), 0);
  for (const int node : boundary(mesh).node_of_vertex) on_boundary[static_cast<std::size_t>(node)] = 1;
  std::mt19937 random(seed);
  // The distributions of the C++ standard differ between libraries.
  const auto uniform = [&] { return 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0; };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (on_boundary[i]) continue;
    Vec3 direction = Vec3::Zero();
    for (int k = 0; k < 3; ++k) direction[k] = uniform();
    mesh.nodes.col(static_cast<Eigen::Index>(i)) += amplitude * edges[i] / std::sqrt(3.0) * direction;
  }
  for (int t = 0; t < static_cast<int>(mesh.tets.cols()); ++t)
    if (!(tet_volume(mesh, t) > 0))
      fail("perturbed mesh: amplitude = {} inverts element {}; use a smaller one", amplitude, t);
  return mesh;
}

}  // namespace palpate::mesh
