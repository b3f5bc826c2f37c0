#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::mesh {

/// Points tied to tetrahedra by barycentric weights (docs/design.md, 4.2): x_i = sum over the 4 nodes of
/// tet[i] of weights(k, i) * x_node.
///
/// A point that no tetrahedron holds belongs to the nearest one, with that one's weights continued outside
/// (some of them negative; they still sum to one).  So the offset to the tetrahedron is kept, the map from
/// nodes to points is linear, every affine map of the nodes is reproduced exactly, and a force at the point
/// that is distributed to the nodes by the same weights keeps its moment: no offset is left that would have
/// to be rotated.
struct Embedding {
  std::vector<int> tet;                              ///< tetrahedron of each point
  Eigen::Matrix<double, 4, Eigen::Dynamic> weights;  ///< 4 x number of points

  /// Number of points.
  int size() const { return static_cast<int>(tet.size()); }
};

/// Largest sum |w| that `embed` accepts: the point moves by up to that many times the motion of a node.
inline constexpr double kLargestWeightSum = 10.0;

/// Report of how the points of an embedding lie.
struct EmbeddingReport {
  int outside = 0;                  ///< points that no tetrahedron holds
  double largest_distance = 0.0;    ///< of a point from its tetrahedron [m]
  int farthest = -1;                ///< that point; -1: none is outside
  double largest_weight_sum = 1.0;  ///< largest sum |w|; 1 where every point is held
  int most_extrapolated = -1;       ///< that point
};

/// Ties each point to the tetrahedron that holds it, else to the nearest one.  Where several are equally near
/// (a shared face, edge or node), the one with the least sum |w| is taken, and of equals (to 1e-9) the first:
/// the answer depends on nothing but the arguments.  Where that sum is above 3, the best of those that are at
/// most a quarter farther is taken, if it is a tenth better.
/// @pre tetrahedra of positive volume (check_tets).
/// @throws Error for a point that is not finite, or whose weights are absurd (kLargestWeightSum), with its
///   index, position and distance
Embedding embed(const TetMesh& mesh, const Points& points, EmbeddingReport* report = nullptr);

/// The points at the positions `nodes` of the mesh's nodes [m].  Allocates only when `points` has another
/// size.
void evaluate(const Embedding& embedding, const Tets& tets, const Points& nodes, Points& points);

/// The transposed map, f_node += w f_point [N]: the virtual work, the resultant and (since sum w x_node is
/// the point) the moment about any origin are preserved.
void add_to_nodes(const Embedding& embedding, const Tets& tets, const Points& point_forces,
                  Points& node_forces);

/// One third of the area vectors of the adjacent faces [m^2], outward; their sum over a closed surface is
/// zero.
void vertex_area_vectors(const Faces& faces, const Points& vertices, Points& area_vectors);

/// Unit normals (of the area vectors; zero where those cancel) and areas of the vertices: one third of the
/// adjacent faces' areas, so they sum to the surface's [m^2].
void vertex_normals_and_areas(const Faces& faces, const Points& vertices, Points& normals, VecX& areas);

}  // namespace palpate::mesh
