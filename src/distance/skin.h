#pragma once
#include <cstdint>
#include <vector>

#include "palpate/mesh/embedding.h"
#include "palpate/mesh/mesh.h"

namespace palpate::distance {

/// Faces per cluster of a skin.
inline constexpr int kClusterFaces = 32;

using NodeIndices = Eigen::Matrix<int, 4, Eigen::Dynamic>;  ///< Nodes per vertex, 4 x n.
using NodeWeights =
    Eigen::Matrix<double, 4, Eigen::Dynamic>;  ///< Weights of these nodes, 4 x n; each column sums to 1.

/// Node of the bounding-volume tree over the clusters of a skin. Its first child is stored directly behind
/// it.
struct ClusterNode {
  int begin = 0, end = 0;  ///< Range of clusters [begin, end).
  int right = 0;           ///< Index of the second child; 0 for a leaf, which holds one cluster.
};

/// Closed triangulated surface embedded in a mesh: vertex i is at x_i = sum over k of weights(k, i) times the
/// position of node nodes(k, i). Topology and rest areas are fixed at assembly.
///
/// Faces are renumbered along a spatial bisection: faces 32 c to 32 c + 31 form cluster c, and aligned
/// runs of 16, 8 and 4 faces are compact too. With Clusters::kConnected, required for self-contact, the
/// faces of each cluster are connected: two sheets in close proximity are put into different clusters, and a
/// cluster with fewer than 32 faces is padded with duplicates of its last face.
struct Skin {
  int node_count = 0;   ///< Number of nodes of the mesh.
  NodeIndices nodes;    ///< Nodes per vertex.
  NodeWeights weights;  ///< Their interpolation weights per vertex.
  Faces faces;          ///< Vertices per face, 3 x face_count().
  /// Original index of each face in the mesh; a repeated index marks a padding duplicate.
  std::vector<int> given_face;
  Faces across;                ///< Face across the edge opposite to each corner.
  std::vector<int> fan_begin;  ///< Offset of each vertex in `fan`, and its length at the end.
  std::vector<int> fan;        ///< Faces around each vertex, ascending.
  VecX area;                   ///< Area per face at rest [m^2]; 0 for a padding duplicate.
  VecX longest_edge;           ///< Longest edge per face at rest [m].
  /// Offset of each cluster in `cluster_vertices`, and its length at the end.
  std::vector<int> cluster_begin;
  std::vector<int> cluster_vertices;  ///< Distinct vertices per cluster, ascending.
  std::vector<int> joined_begin;      ///< Offset of each cluster in `joined`, and its length at the end.
  std::vector<int> joined;            ///< Clusters that share a vertex with each cluster, ascending.
  /// Nodes and weights of the vertices that lie far outside their tetrahedra: those with the largest sums of
  /// |weights|, at most a tenth of all vertices.
  NodeIndices far_nodes;
  NodeWeights far_weights;
  /// Largest sum of |weights| among all other vertices: bound on the ratio of vertex to node displacement.
  double weight_sum = 0.0;
  /// Bounding-volume tree; parents precede children and the root is the first entry.
  std::vector<ClusterNode> tree;

  int vertex_count() const { return static_cast<int>(nodes.cols()); }
  int face_count() const { return static_cast<int>(faces.cols()); }
  int cluster_count() const { return (face_count() + kClusterFaces - 1) / kClusterFaces; }
};

/// Connectivity of clusters: kConnected requires that the faces of each cluster are connected by shared
/// vertices.
enum class Clusters { kAny, kConnected };

/// Builds a skin embedded in a tetrahedral mesh.
/// @param rest        closed surface at rest [m], oriented outwards
/// @param embedding   tetrahedron and barycentric weights per vertex of the surface
/// @param tets        nodes per tetrahedron
/// @param node_count  number of nodes of the tetrahedral mesh
/// @param clusters    kConnected for a skin that may touch itself
/// @throws Error where an edge does not belong to exactly two faces of opposite direction, where a face has
///   no area, or where a weight or position is not finite
Skin make_skin(const TriMesh& rest, const mesh::Embedding& embedding, const Tets& tets, int node_count,
               Clusters clusters = Clusters::kAny);

/// Builds a skin whose vertices are the nodes. Throws like the overload for tetrahedral meshes.
Skin make_skin(const TriMesh& rest, Clusters clusters = Clusters::kAny);

/// Builds a rigid skin, interpolated from the four corners of a tetrahedron around it. Throws like the
/// overload for tetrahedral meshes, and where the surface's bounding box has no volume.
/// @param rest     closed surface, oriented outwards [m]
/// @param corners  3 x 4, receives the corners in the mesh's axes [m]
Skin make_rigid_skin(const TriMesh& rest, Points& corners);

}  // namespace palpate::distance
