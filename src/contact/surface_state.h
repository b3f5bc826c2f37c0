#pragma once
#include <array>
#include <vector>

#include "contact/carrier.h"
#include "contact/contact_view.h"
#include "contact/coupled_nodes.h"
#include "palpate/contact/contact_force.h"

namespace palpate::contact {

/// A NodeSurface at a state: where its vertices are, which nodes of the State carry them.
class SurfaceState {
 public:
  /// @throws InternalError for faces that name a vertex which is not there, and for an embedding that names
  ///   a tetrahedron or node which is not
  explicit SurfaceState(NodeSurface surface);

  void update(const dynamics::StateView& state);

  bool is_skin() const { return surface_.node_of_vertex.empty(); }
  int vertex_count() const { return vertex_count_; }
  int face_count() const { return static_cast<int>(surface_.faces.cols()); }
  const Faces& faces() const { return surface_.faces; }
  const NodeSurface& surface() const { return surface_; }
  const Points& positions() const;  ///< of all vertices
  /// Of one.  A skin's vertices are evaluated when they are asked for, so that a query pays for those that
  /// may touch, not for the skin.
  Vec3 position(int vertex) const {
    if (is_skin() && evaluated_[static_cast<std::size_t>(vertex)] != static_cast<std::uint32_t>(updates_))
      evaluate(vertex);
    return positions_.col(vertex);
  }
  /// Positions of a skin's vertices that were computed so far, over all updates.
  long evaluations() const { return evaluations_; }
  const Points& nodes() const { return nodes_; }  ///< of the block, of a skin only
  /// What the vertices hang on, now: the nodes of a skin, else they themselves.
  const Points& carrying_points() const { return is_skin() ? nodes_ : positions_; }
  /// Where a vertex is when these are there.
  Vec3 position(int vertex, const Points& carriers) const;
  Vec3 velocity(int vertex, const dynamics::StateView& state) const;
  /// Of all nodes of the block: a point of the surface moves with a mean of some of them, of weights that sum
  /// to one.  @pre updated
  Eigen::Map<const Points> node_velocities(const dynamics::StateView& state) const;
  /// Largest sum |w| of a vertex' weights: one, or more where a skin lies outside its tetrahedra.
  double weight_sum() const { return weight_sum_; }
  /// One vertex as a contact point; its nodes are counted over all node blocks.
  SurfacePoint vertex_point(int vertex) const;
  /// What may carry a point of a face near one of its corners, by number (surface_state.cpp): the first
  /// choice whose weights are bounded, the last one in any case.
  int carrier_choices() const;
  int carrier_choice(int face, int corner, int choice) const;
  /// As it stands, for places in these axes; NaN where it can carry none.
  Carrier carrier(int number, const ContactAxes& axes) const;
  /// The point of a face with these weights of its corners, at x: on the corners themselves where they are
  /// nodes, else on the first choice of tetrahedra.
  CarriedPoint carried(int face, const Vec3& weights, const Vec3& x, const Vec3& normal) const;
  /// One third of the area vectors of the adjacent faces, deformed [m^2]; outward.  Sums over `faces` with a
  /// vertex in `wanted`.
  void area_vectors(const std::vector<char>& wanted, Points& areas) const;
  /// Mean length of the faces' edges at the last update [m].
  double mean_edge() const;

  /// Nodes by the body's elements, of a skin, else by the faces; as they are counted now.
  NodeNeighbours neighbours() const;
  /// What vertex points couple, and what face points couple.
  void add_vertex_pattern(dynamics::PatternBuilder& pattern) const;
  void add_face_pattern(dynamics::PatternBuilder& pattern) const;
  std::uint64_t pattern_version() const { return pattern_version_; }
  /// nodes by themselves couple nothing, wherever they stand
  std::uint64_t vertex_pattern_version() const { return is_skin() ? pattern_version_ : 0; }

 private:
  int tet_of(int vertex) const { return surface_.embedding.tet[static_cast<std::size_t>(vertex)]; }
  int node_of_tet(int tet, int corner) const { return node_offset_ + surface_.tets(corner, tet); }
  int node(int vertex) const {
    return node_offset_ + surface_.node_of_vertex[static_cast<std::size_t>(vertex)];
  }

  NodeSurface surface_;
  std::vector<int> carriers_;  ///< of a skin: the tetrahedra that carry a vertex, each once
  double weight_sum_ = 1.0;
  int node_offset_ = 0;
  std::uint64_t pattern_version_ = 0;
  void evaluate(int vertex) const;

  int vertex_count_ = 0;
  mutable Points positions_;
  mutable std::vector<std::uint32_t> evaluated_;  ///< of a skin's vertices: the update that they are of
  mutable std::uint64_t all_evaluated_ = 0;       ///< likewise, of all of them
  mutable long evaluations_ = 0;
  Points nodes_;
  std::uint64_t updates_ = 1;
};

/// A point of a frame, given in the world.
SurfacePoint frame_point(int frame, const Pose& inverse_pose, const Vec3& world);

}  // namespace palpate::contact
