#pragma once
#include <array>
#include <string_view>
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::fem {

/// Rest shape of linear tetrahedra, one array per number (structure of arrays: neighbouring elements fill
/// vector lanes).
///
/// With the rest edges Dm = [X1-X0, X2-X0, X3-X0] the rows of Dm^-1 are the gradients g_a of the shape
/// functions of nodes 1, 2, 3, and g_0 = -(g_1 + g_2 + g_3).
struct RestElements {
  std::array<std::vector<int>, 4> node;
  /// Entry (r, c) of Dm^-1 is inverse_edges[3 r + c] [1/m].
  std::array<std::vector<double>, 9> inverse_edges;
  std::vector<double> volume;  ///< [m^3]
  /// A quarter of each adjacent tetrahedron's volume [m^3], one per node.
  std::vector<double> nodal_volume;

  int count() const { return static_cast<int>(volume.size()); }
  int node_count() const { return static_cast<int>(nodal_volume.size()); }

  /// Returns Dm^-1; its rows are g_1, g_2, g_3.
  Mat3 gradients(std::size_t e) const {
    Mat3 m;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) m(r, c) = inverse_edges[static_cast<std::size_t>(3 * r + c)][e];
    return m;
  }
  /// Returns Ds = [x1-x0, x2-x0, x3-x0] of any nodal vector field (positions, velocities, directions).
  /// `field` starts at node 0 of the body.
  Mat3 edges(std::size_t e, const double* field) const {
    const Eigen::Map<const Vec3> origin(field + 3 * node[0][e]);
    Mat3 m;
    for (std::size_t a = 1; a < 4; ++a)
      m.col(static_cast<int>(a) - 1) = Eigen::Map<const Vec3>(field + 3 * node[a][e]) - origin;
    return m;
  }
};

/// Computes the rest shapes.
/// @throws Error if a tetrahedron has an invalid node or no positive, finite volume; `where` begins the
///   message.
RestElements make_rest_elements(const TetMesh& rest, std::string_view where);

}  // namespace palpate::fem
