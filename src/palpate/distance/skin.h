#pragma once
#include <cstdint>
#include <vector>

#include "palpate/mesh/embedding.h"
#include "palpate/mesh/mesh.h"

namespace palpate::distance {

/// Faces per cluster of a skin.
inline constexpr int kClusterFaces = 32;

using NodeIndices = Eigen::Matrix<int, 4, Eigen::Dynamic>;  ///< 4 x n, nodes of each vertex
using NodeWeights =
    Eigen::Matrix<double, 4, Eigen::Dynamic>;  ///< 4 x n, their weights; each column sums to 1

/// A box of clusters and its two halves: the tree that searches descend.
struct ClusterNode {
  int begin = 0, end = 0;  ///< clusters
  int right = 0;           ///< second half; the first one follows its parent; 0: one cluster
};

/// A closed triangulated skin whose vertices are carried by nodes, x_i = sum over k of weights(k, i) times
/// the position of node nodes(k, i).  Topology and rest areas, fixed at assembly.
///
/// Faces are renumbered along a spatial bisection, so that faces 32 c to 32 c + 31 are cluster c, and runs of
/// 16, 8 and 4 of them are compact, too.  Of a skin that touches itself (Clusters::kConnected) the faces of a
/// cluster hang together: two sheets that lie on each other have clusters of their own, filled up with
/// repetitions of the last face.
struct Skin {
  int node_count = 0;
  NodeIndices nodes;
  NodeWeights weights;
  Faces faces;
  std::vector<int> given_face;        ///< number that each face had in the mesh; twice: a repetition
  Faces across;                       ///< face beyond the edge opposite to each corner
  std::vector<int> fan_begin;         ///< of each vertex in `fan`, and its length at the end
  std::vector<int> fan;               ///< faces around each vertex, ascending
  VecX area;                          ///< of each face at rest [m^2]; 0 of a repetition
  VecX longest_edge;                  ///< of each face at rest [m]
  std::vector<int> cluster_begin;     ///< of each cluster in `cluster_vertices`, and its length at the end
  std::vector<int> cluster_vertices;  ///< vertices of each cluster, each once
  std::vector<int> joined_begin;      ///< of each cluster in `joined`, and its length at the end
  std::vector<int> joined;            ///< clusters that share a vertex with each, ascending
  /// Carriers of the vertices far outside their tetrahedra: those with the largest sums of |weights|, at most
  /// a tenth of all.
  NodeIndices far_nodes;
  NodeWeights far_weights;
  double weight_sum =
      0.0;  ///< largest sum of |weights| of the others: they move by at most that times a node
  std::vector<ClusterNode> tree;  ///< parents before children; the root is the first

  int vertex_count() const { return static_cast<int>(nodes.cols()); }
  int face_count() const { return static_cast<int>(faces.cols()); }
  int cluster_count() const { return (face_count() + kClusterFaces - 1) / kClusterFaces; }
};

/// Whether the faces of a cluster have to hang together by vertices.
enum class Clusters { kAny, kConnected };

/// A skin embedded in tetrahedra.
/// @param rest  closed and oriented outwards, at rest [m]  @param node_count  nodes of the tetrahedral mesh
/// @throws Error where an edge does not belong to exactly two faces of opposite direction, where a face has
/// no
///   area, or where a weight or position is not finite
Skin make_skin(const TriMesh& rest, const mesh::Embedding& embedding, const Tets& tets, int node_count,
               Clusters clusters = Clusters::kAny);

/// A skin whose vertices are its nodes.  Throws as above.
Skin make_skin(const TriMesh& rest, Clusters clusters = Clusters::kAny);

/// A skin that moves as one, carried by the corners of a tetrahedron around it.  Throws as above.
/// @param corners  3 x 4, receives them [m], in the mesh's axes
Skin make_rigid_skin(const TriMesh& rest, Points& corners);

}  // namespace palpate::distance
