#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::mesh {

/// Barycentric coordinates of a point in a tetrahedron, inside or not.
Eigen::Vector4d tet_weights(const TetMesh& mesh, int tet, const Vec3& point);

/// Distance from a point to a tetrahedron; zero inside [m].
double tet_distance(const TetMesh& mesh, int tet, const Vec3& point);

/// A tree of boxes around the tetrahedra, for the nearest to a point.
class TetTree {
 public:
  explicit TetTree(const TetMesh& mesh);
  /// All tetrahedra whose distance to `point` is at most the least one + `tolerance`, ascending; returns the
  /// least distance [m].
  /// @param guess  a tetrahedron that is probably close; changes the time, not the answer
  double nearest(const Vec3& point, double tolerance, int guess, std::vector<int>& tets);

 private:
  struct Box {
    Vec3 low, high;
    int first, count;  ///< leaf: entries of order_; inner node: count = 0, children at first and first + 1
  };
  void build(std::size_t box, int first, int count);
  double box_distance(const Box& box, const Vec3& point) const;

  const TetMesh& mesh_;
  std::vector<int> order_;
  std::vector<Box> boxes_;
  struct Candidate {
    int tet;
    double distance;
  };
  std::vector<Candidate> candidates_;
  std::vector<int> open_;
};

}  // namespace palpate::mesh
