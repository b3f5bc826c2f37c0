#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::mesh {

/// Points embedded in tetrahedra by barycentric weights (docs/theory/proxies.md):
///     x_i = sum_k weights(k, i) x_node(k),  k = 0 ... 3 over the nodes of tet[i].
///
/// A point outside all tetrahedra belongs to the nearest one, whose weights are extrapolated (some are
/// negative; they still sum to one).  The offset to the tetrahedron is therefore kept, the map from nodes to
/// points is linear, every affine map of the nodes is reproduced exactly, and a force at the point that is
/// distributed to the nodes by the same weights keeps its moment: no separate offset has to be rotated.
struct Embedding {
  std::vector<int> tet;                              ///< tetrahedron of each point
  Eigen::Matrix<double, 4, Eigen::Dynamic> weights;  ///< 4 x number of points

  /// Returns the number of points.
  int size() const { return static_cast<int>(tet.size()); }
};

/// Largest sum |w| that `embed` accepts: the point moves by up to this multiple of the motion of a node.
inline constexpr double kLargestWeightSum = 10.0;

/// Report on the points of an embedding.
struct EmbeddingReport {
  int outside = 0;                  ///< number of points outside all tetrahedra
  double largest_distance = 0.0;    ///< largest distance of a point from its tetrahedron [m]
  int farthest = -1;                ///< that point; -1: none is outside
  double largest_weight_sum = 1.0;  ///< largest sum |w|; 1 if no point is outside
  int most_extrapolated = -1;       ///< that point; -1: none is outside
};

/// Embeds each point in the tetrahedron that contains it, else in the nearest one.  If several are equally
/// near (a shared face, edge or node), the one with the least sum |w| is taken, and of equals (to 1e-9) the
/// first, so that the result depends on the arguments only.  If that sum is above 3, tetrahedra at most a
/// quarter farther are considered too, and the best of them is taken if its sum is at least a tenth less.
/// @pre tetrahedra of positive volume (check_tets).
/// @throws Error for a point that is not finite, or whose weights are too large (kLargestWeightSum), with its
///   index, position and distance
Embedding embed(const TetMesh& mesh, const Points& points, EmbeddingReport* report = nullptr);

/// Computes the points for the positions `nodes` of the mesh's nodes [m].  Allocates only when `points` has
/// another size.
void evaluate(const Embedding& embedding, const Tets& tets, const Points& nodes, Points& points);

/// Applies the transposed map, f_node += w f_point [N].  It preserves the virtual work, the resultant and
/// (since sum w x_node is the point) the moment about any origin.
void add_to_nodes(const Embedding& embedding, const Tets& tets, const Points& point_forces,
                  Points& node_forces);

/// Computes one third of the area vectors of the adjacent faces per vertex [m^2], outward; their sum over a
/// closed surface is zero.
void vertex_area_vectors(const Faces& faces, const Points& vertices, Points& area_vectors);

/// Computes unit normals (directions of the area vectors; zero where those cancel) and areas of the vertices:
/// one third of the adjacent faces' areas, so that they sum to the surface's area [m^2].
void vertex_normals_and_areas(const Faces& faces, const Points& vertices, Points& normals, VecX& areas);

}  // namespace palpate::mesh
