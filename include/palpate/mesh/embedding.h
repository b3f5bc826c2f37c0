#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::mesh {

/// Points tied to tetrahedra by barycentric weights (DESIGN 3.2): x_i = sum over the 4 nodes of tet[i] of weights(k, i) * x_node.
///
/// A point that no tetrahedron holds belongs to the nearest one, with that one's weights continued outside (some of them negative; they still sum to one).
/// So the offset to the tetrahedron is kept, the map from nodes to points is linear, every affine map of the nodes is reproduced exactly, and a force at the
/// point that is handed to the nodes by the same weights keeps its moment: nothing of an offset is left to turn.
struct Embedding {
  std::vector<int> tet;                   ///< tetrahedron of each point
  Eigen::Matrix<double, 4, Eigen::Dynamic> weights;  ///< 4 x number of points
};

}  // namespace palpate::mesh
