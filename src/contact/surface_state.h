#pragma once
#include <array>
#include <vector>

#include "contact/carrier.h"
#include "contact/contact_view.h"
#include "contact/coupled_nodes.h"
#include "palpate/contact/side.h"

namespace palpate::contact {

/// NodeSurface at a state: positions of its vertices, and the nodes of the State that carry them.
class SurfaceState {
 public:
  /// @throws InternalError for faces with invalid vertex indices, and for an embedding with invalid
  ///   tetrahedra or nodes
  explicit SurfaceState(NodeSurface surface);

  /// Reads the nodes at a state.
  void update(const dynamics::StateView& state);

  bool is_skin() const { return surface_.node_of_vertex.empty(); }
  int vertex_count() const { return vertex_count_; }
  int face_count() const { return static_cast<int>(surface_.faces.cols()); }
  const Faces& faces() const { return surface_.faces; }
  const NodeSurface& surface() const { return surface_; }
  const Points& positions() const;  ///< World positions of all vertices [m].
  /// Returns the world position of one vertex [m]. Vertices of a skin are evaluated on demand, so that the
  /// cost of a query depends on the vertices that may touch, not on the skin.
  Vec3 position(int vertex) const {
    if (is_skin() && evaluated_[static_cast<std::size_t>(vertex)] != static_cast<std::uint32_t>(updates_))
      evaluate(vertex);
    return positions_.col(vertex);
  }
  /// Returns the number of vertex positions of a skin evaluated so far, over all updates.
  long evaluations() const { return evaluations_; }
  const Points& nodes() const { return nodes_; }  ///< Nodes of the block; for a skin only.
  /// Returns the points that carry the vertices, now: the nodes for a skin, else the vertices.
  const Points& carrying_points() const { return is_skin() ? nodes_ : positions_; }
  /// Returns the position of a vertex for given positions of these points.
  Vec3 position(int vertex, const Points& carriers) const;
  /// Returns the velocity of a vertex [m/s].
  Vec3 velocity(int vertex, const dynamics::StateView& state) const;
  /// Returns the velocities of all nodes of the block: each point of the surface moves with a weighted
  /// mean of some of them, with weights that sum to one. @pre updated
  Eigen::Map<const Points> node_velocities(const dynamics::StateView& state) const;
  /// Returns the largest sum |w| of a vertex' weights: one, or more where a skin lies outside its tetrahedra.
  double weight_sum() const { return weight_sum_; }
  /// Returns the contact point of one vertex, with nodes counted over all node blocks.
  SurfacePoint vertex_point(int vertex) const;
  /// Candidate carriers, by number, for a point of a face near one of its corners (surface_state.cpp): the
  /// first choice with bounded weights is used, and the last one in any case.
  int carrier_choices() const;
  int carrier_choice(int face, int corner, int choice) const;
  /// Returns a carrier in the present configuration, for places in these axes; NaN where it can carry no
  /// point.
  Carrier carrier(int number, const ContactAxes& axes) const;
  /// Returns the point of a face with these barycentric weights, at x: carried by the corners where these are
  /// nodes, else by the first suitable tetrahedron.
  CarriedPoint carried(int face, const Vec3& weights, const Vec3& x, const Vec3& normal) const;
  /// Computes one third of the area vectors of the adjacent faces for each vertex in `wanted`, in the
  /// deformed configuration, outward [m^2].
  void area_vectors(const std::vector<char>& requested, Points& areas) const;
  /// Returns the mean edge length of the faces at the last update [m].
  double mean_edge() const;

  /// Returns the adjacency of nodes by the body's elements for a skin, else by the faces; in the present
  /// numbering.
  NodeNeighbours neighbours() const;
  /// Add the node pairs that vertex points couple, and those of face points.
  void add_vertex_pattern(dynamics::PatternBuilder& pattern) const;
  void add_face_pattern(dynamics::PatternBuilder& pattern) const;
  std::uint64_t pattern_version() const { return pattern_version_; }
  /// Vertices that are nodes couple no pairs, whatever their numbering.
  std::uint64_t vertex_pattern_version() const { return is_skin() ? pattern_version_ : 0; }

 private:
  int tet_of(int vertex) const { return surface_.embedding.tet[static_cast<std::size_t>(vertex)]; }
  int node_of_tet(int tet, int corner) const { return node_offset_ + surface_.tets(corner, tet); }
  int node(int vertex) const {
    return node_offset_ + surface_.node_of_vertex[static_cast<std::size_t>(vertex)];
  }

  NodeSurface surface_;
  std::vector<int> carriers_;  ///< Skin only: the tetrahedra that carry a vertex, each once.
  double weight_sum_ = 1.0;
  int node_offset_ = 0;
  std::uint64_t pattern_version_ = 0;
  void evaluate(int vertex) const;

  int vertex_count_ = 0;
  mutable Points positions_;
  mutable std::vector<std::uint32_t> evaluated_;  ///< Update of the last evaluation, per vertex of a skin.
  mutable std::uint64_t all_evaluated_ = 0;       ///< Update of the last evaluation of all vertices.
  mutable long evaluations_ = 0;
  Points nodes_;
  std::uint64_t updates_ = 1;
};

/// Returns the point of a frame at a world position.
SurfacePoint frame_point(int frame, const Pose& inverse_pose, const Vec3& world);

}  // namespace palpate::contact
