#pragma once
#include <array>
#include <vector>

#include "palpate/core/types.h"

namespace palpate::dynamics {

/// Symmetric positive semi-definite matrix over the nodes, as a sum of small matrices on up to eight nodes
/// each: stiffness and damping of contact. It has no sparsity pattern: the coupled nodes may change with
/// every matrix, without a symbolic analysis.
///
/// Contact points between two soft bodies depend on their relative motion only: `relative` summands have zero
/// row sums, and products with them use the nodes' motions relative to the first node, so that rounding acts
/// on differences (as in zero_row_sum_matrix.h).
struct PointStiffness {
  static constexpr int kMostNodes = 8;  ///< Four per side.
  /// Weights of the nodes; zero beyond their count.
  using Weights = Eigen::Matrix<double, kMostNodes, 1>;
  /// Nodes that one summand couples.
  struct Nodes {
    int count = 0;                       ///< Number of nodes.
    bool relative = false;               ///< Row sums are zero: a rigid translation causes no force.
    std::array<int, kMostNodes> node{};  ///< Node numbers, over all node blocks; a node may occur twice.
  };
  /// Summand of the motion of one point, sum w_i x_i: block (i, j) is w_i w_j C.
  struct OfPoint {
    Nodes nodes;                       ///< Nodes that carry the point.
    Weights weight = Weights::Zero();  ///< Weight w_i per node.
    Mat3 C = Mat3::Zero();             ///< Symmetric, positive semi-definite [N/m].
  };
  std::vector<OfPoint> points;  ///< All summands.

  /// Returns whether there are no summands.
  bool empty() const { return points.empty(); }
  /// Removes all summands; memory is kept.
  void clear() { points.clear(); }
  /// Adds y += by C x; x and y contain at least the rows of the nodes.
  void add_product(const VecX& x, double by, VecX& y) const;
};

}  // namespace palpate::dynamics
