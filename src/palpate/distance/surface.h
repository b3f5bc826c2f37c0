#pragma once
#include <limits>
#include <vector>

#include "palpate/distance/skin.h"

namespace palpate::distance {

/// A point of a triangle.  A weight is zero exactly where the point lies on the edge opposite to its corner:
/// without a zero the feature is the face, with one an edge, with two a vertex.
struct TrianglePoint {
  Vec3 weights = Vec3::Zero();
  Vec3 away = Vec3::Zero();  ///< from it to the point that was asked for [m]
  double distance2 = 0.0;    ///< [m^2]
};
TrianglePoint nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x);

/// Nearest point of a skin.
struct Foot {
  int face = -1;  ///< -1: none within the bound
  TrianglePoint at;
};

/// Number of searches and of the triangles that they tested.
struct SearchCount {
  long searches = 0, triangles = 0;
};

/// A skin where its nodes are now, and exact nearest points of it.
///
/// Vertices are evaluated by clusters, when something asks for them: a state costs the nodes, a tenth of the
/// skin, and what is near.
///
/// The nearest point is the least pair (squared distance, face), where the distance of a face is the one that
/// nearest_on_triangle() computes.  Whatever bounds the search, a face is left out only where a lower bound
/// on that value exceeds one that was computed for another face.  So the answer is a function of positions
/// alone.
class Surface {
 public:
  /// @param skin  outlives the surface
  explicit Surface(const Skin& skin);

  /// Takes the nodes' positions.  @param nodes  x y z of each node [m]
  void move(const double* nodes);
  /// Mean displacement of the nodes in the last move() [m].
  const Vec3& shift() const { return shift_; }
  /// No vertex was displaced by more than that from shift() in the last move() [m]; infinite in the first.
  double stretch() const { return stretch_; }

  /// Returns a bound on how far a vertex' velocity is from one, where the nodes have these [m/s].
  double spread(const double* node_velocities, const Vec3& about) const;

  const Skin& skin() const { return skin_; }
  /// Box around all vertices, the same whatever was before.
  const Eigen::AlignedBox3d& bound() const { return bound_; }
  /// Box around what is below a node of the skin's tree: the bounding box of a cluster that was placed at
  /// this state, else one that holds it.
  const Eigen::AlignedBox3d& box(int tree_node) const { return boxes_[static_cast<std::size_t>(tree_node)]; }
  /// Evaluates the vertices of a cluster and its box, unless they are.
  void place(int cluster) const {
    if (placed_[static_cast<std::size_t>(cluster)] != state_) evaluate(cluster);
  }
  /// Four numbers each, the last one without a meaning.  @pre the cluster was placed
  const double* vertices() const { return vertices_.data(); }
  auto vertex(int v) const { return vertices_.col(v).head<3>(); }
  auto corner(int face, int k) const { return vertex(skin_.faces(k, face)); }
  /// Point of a face by weights of its corners.
  Vec3 point(int face, const Vec3& weights) const;

  TrianglePoint nearest_on_face(int face, const Vec3& x) const;
  /// @param start  a face that is probably near, -1: none.  It bounds the search and changes no result.
  Foot nearest(const Vec3& x, int start = -1) const;
  /// Nearest point among a face and those that share the feature with it where its foot lies, as far as that
  /// leads. Equal to nearest() where `face` holds the nearest point but for rounding.
  Foot nearest_around(const Vec3& x, int face) const;
  /// The pseudonormal N where a foot lies, not of unit length: the face's normal, the sum of those of an
  /// edge's two faces, or the sum of those around a vertex weighted by their angles (Baerentzen, Aanaes
  /// 2005).
  Vec3 outward(const Foot& foot) const;
  /// Whether x lies inside the skin, from its nearest point: the sign of (x - y) . N, right for every closed
  /// surface.
  bool is_inside(const Foot& foot) const { return foot.at.away.dot(outward(foot)) < 0.0; }

  SearchCount count() const { return count_; }

 private:
  using Padded = Eigen::Matrix<double, 4, Eigen::Dynamic>;

  void carry_far(const Padded& of_nodes) const;
  double farthest(const Padded& of_nodes, const Vec3& about) const;
  void evaluate(int cluster) const;
  Vec3 unit_normal(int face) const;
  void search_cluster(int cluster, const Vec3& x, Foot& best) const;

  const Skin& skin_;
  Padded nodes_;
  mutable Padded way_;         ///< of the nodes: displacements, or velocities
  mutable Padded far_;         ///< what the skin's far_nodes carry, of positions, ways or velocities
  std::vector<int> far_list_;  ///< 0, 1, 2, ...
  Vec3 shift_ = Vec3::Zero();
  double stretch_ = std::numeric_limits<double>::infinity();
  Eigen::AlignedBox3d bound_;
  std::vector<int> leaf_;            ///< of each cluster in the tree
  int state_ = 0;                    ///< number of the last move()
  mutable std::vector<int> placed_;  ///< state in which each cluster was evaluated
  mutable Padded vertices_;
  mutable std::vector<Eigen::AlignedBox3d> boxes_;
  mutable SearchCount count_;
};

}  // namespace palpate::distance
