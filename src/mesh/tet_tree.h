#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::mesh {

/// Returns the barycentric coordinates of a point relative to a tetrahedron, inside or not.
Eigen::Vector4d tet_weights(const TetMesh& mesh, int tet, const Vec3& point);

/// Returns the distance from a point to a tetrahedron; zero inside [m].
double tet_distance(const TetMesh& mesh, int tet, const Vec3& point);

/// Tree of boxes around tetrahedra, for nearest-tetrahedron queries.
class TetTree {
 public:
  explicit TetTree(const TetMesh& mesh);
  /// Finds all tetrahedra whose distance to `point` is at most the least distance + `tolerance`, ascending.
  /// @param guess  a tetrahedron that is probably close; affects the time, not the result
  /// @returns the least distance [m]
  double nearest(const Vec3& point, double tolerance, int guess, std::vector<int>& tets);

 private:
  /// Node of the tree.
  struct Box {
    Vec3 low, high;
    int first, count;  ///< leaf: entries of order_; inner node: count = 0, children at first and first + 1
  };
  /// Builds the subtree of `box` over order_[first, first + count) by median splits.
  void build(std::size_t box, int first, int count);
  /// Returns the distance from a point to a box; zero inside [m].
  double box_distance(const Box& box, const Vec3& point) const;

  const TetMesh& mesh_;
  std::vector<int> order_;
  std::vector<Box> boxes_;
  /// Tetrahedron that was within the tolerance when it was tested.
  struct Candidate {
    int tet;
    double distance;
  };
  std::vector<Candidate> candidates_;
  std::vector<int> open_;
};

}  // namespace palpate::mesh
