#pragma once
#include <limits>
#include <vector>

#include "distance/skin.h"

namespace palpate::distance {

/// Nearest point of a triangle. A weight is exactly zero where the point lies on the edge opposite to its
/// corner. Without a zero weight the nearest feature is the face, one zero: an edge, two zeros: a vertex.
struct TrianglePoint {
  Vec3 weights = Vec3::Zero();  ///< Barycentric weights of the corners.
  Vec3 away = Vec3::Zero();     ///< Vector from the nearest point to the query point [m].
  double distance2 = 0.0;       ///< Squared distance [m^2].
};
/// Computes the point of triangle (a, b, c) nearest to x [m]. Degenerate triangles are allowed.
TrianglePoint nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x);

/// Nearest point of a skin to a query point.
struct Foot {
  int face = -1;  ///< Face that contains it; -1: none within the bound of the search.
  /// Nearest point on that face.
  TrianglePoint at;
};

/// Number of searches and of triangles tested in them.
struct SearchCount {
  long searches = 0, triangles = 0;
};

/// Current configuration of a skin, with exact nearest-point queries.
///
/// Vertices are evaluated on demand, cluster by cluster: the cost per state is proportional to the nodes, a
/// tenth of the vertices, and the clusters near the queries; with Tree::kFit, to all clusters.
///
/// The nearest point is the minimum of the pair (squared distance, face), with the distance that
/// nearest_on_triangle() computes. Whatever the initial bound of the search, a face is skipped only where a
/// lower bound on its distance exceeds the distance computed for another face. The result is therefore a
/// function of the positions alone.
class Surface {
 public:
  /// @param skin  must outlive the surface
  explicit Surface(const Skin& skin);

  /// Upkeep of the tree in move(): kFit computes the box of every node from its children's, at a cost
  /// proportional to the clusters; kKeep keeps the boxes, and box() displaces those that are requested.
  enum class Tree { kFit, kKeep };
  /// Sets the nodes' positions. @param nodes  x y z per node [m]
  void move(const double* nodes, Tree tree = Tree::kFit);
  /// Returns the mean displacement of the nodes in the last move() [m].
  const Vec3& shift() const { return shift_; }
  /// Returns an upper bound on the distance of any vertex' displacement from shift() in the last move() [m];
  /// infinite in the first.
  double stretch() const { return stretch_; }

  /// Returns an upper bound on |v - about| over all vertices [m/s].
  /// @param node_velocities  x y z per node [m/s]  @param about  reference velocity [m/s]
  double spread(const double* node_velocities, const Vec3& about) const;

  const Skin& skin() const { return skin_; }
  /// Returns a box around all vertices; it depends on the current positions only.
  const Eigen::AlignedBox3d& bound() const { return bound_; }
  /// Returns a box around all vertices below a node of the skin's tree: the tight bounding box for a cluster
  /// that was placed in the current state, otherwise a box that contains it.
  Eigen::AlignedBox3d box(int tree_node) const {
    const auto i = static_cast<std::size_t>(tree_node);
    const Vec3 moved = path_.way - since_[i].way, wider = Vec3::Constant(path_.wider - since_[i].wider);
    return {boxes_[i].min() + moved - wider, boxes_[i].max() + moved + wider};
  }
  /// Evaluates the vertices and the bounding box of a cluster, unless they are up to date.
  void place(int cluster) const {
    if (placed_[static_cast<std::size_t>(cluster)] != state_) evaluate(cluster);
  }
  /// Returns the vertex positions, four numbers per vertex, the fourth of them unused. @pre the cluster was
  /// placed
  const double* vertices() const { return vertices_.data(); }
  /// Returns the position of vertex v [m]. @pre the cluster was placed
  auto vertex(int v) const { return vertices_.col(v).head<3>(); }
  /// Returns the position of corner k of a face [m]. @pre the cluster was placed
  auto corner(int face, int k) const { return vertex(skin_.faces(k, face)); }
  /// Returns the point of a face with the given barycentric weights [m].
  Vec3 point(int face, const Vec3& weights) const;

  /// Computes the point of a face nearest to x.
  TrianglePoint nearest_on_face(int face, const Vec3& x) const;
  /// Finds the nearest point of the whole surface.
  /// @param x  query point [m]
  /// @param start  initial guess of the nearest face, -1: none; it bounds the search and does not change the
  ///   result
  Foot nearest(const Vec3& x, int start = -1) const;
  /// Finds the nearest point by local descent: from `face` to the faces that share the feature (edge or
  /// vertex) of the current nearest point, until none of them is nearer. The result equals nearest(), up to
  /// rounding, if `face` contains the nearest point.
  Foot nearest_around(const Vec3& x, int face) const;
  /// Returns the angle-weighted pseudonormal N at a foot, not normalised: the normal of the face, the sum of
  /// the unit normals of an edge's two faces, or the sum of those around a vertex weighted by their angles
  /// (Baerentzen, Aanaes 2005).
  Vec3 outward(const Foot& foot) const;
  /// Returns whether the query point x lies inside the skin, given its nearest point y: the sign of
  /// (x - y) . N, which is correct for every closed surface.
  bool is_inside(const Foot& foot) const { return foot.at.away.dot(outward(foot)) < 0.0; }

  /// Returns the counters of nearest() since construction.
  SearchCount count() const { return count_; }

 private:
  using Padded = Eigen::Matrix<double, 4, Eigen::Dynamic>;

  struct Extent;
  void carry_far(const Padded& of_nodes, Padded& far) const;
  double farthest(const Padded& nodes, const double* nodes_before, const Padded& far,
                  const double* far_before, const Vec3& about, Extent& extent) const;
  void fit_tree(bool is_known);
  void evaluate(int cluster) const;
  Vec3 unit_normal(int face) const;
  void search_cluster(int cluster, const Vec3& x, Foot& best) const;

  const Skin& skin_;
  Padded nodes_;
  mutable Padded before_;  ///< Positions before the last move(), or velocities of the nodes.
  /// Positions interpolated from the skin's far_nodes; before the last move(), or velocities.
  mutable Padded far_, far_before_;
  double far_sum_ = 0.0;       ///< Largest sum of |weights| in far_weights.
  std::vector<int> far_list_;  ///< Identity index list 0, 1, 2, ...
  Vec3 shift_ = Vec3::Zero();
  double stretch_ = std::numeric_limits<double>::infinity();
  Eigen::AlignedBox3d bound_;
  std::vector<int> leaf_;            ///< Leaf of the tree per cluster.
  int state_ = 0;                    ///< Index of the last move().
  mutable std::vector<int> placed_;  ///< State in which each cluster was last evaluated.
  mutable Padded vertices_;
  /// Sums over all moves since the tree was fitted: displacements shift(), and bounds on the distance of a
  /// vertex' displacement from it [m].
  struct Path {
    Vec3 way = Vec3::Zero();
    double wider = 0.0;
  };
  Path path_;
  mutable std::vector<Eigen::AlignedBox3d> boxes_;  ///< Boxes when last computed, and `path_` at that time.
  mutable std::vector<Path> since_;
  mutable SearchCount count_;
};

}  // namespace palpate::distance
