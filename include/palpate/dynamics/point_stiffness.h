#pragma once
#include <array>
#include <vector>

#include "palpate/core/types.h"

namespace palpate::dynamics {

/// A symmetric, positive semi-definite matrix over the nodes, as a sum of small ones on up to eight nodes
/// each: stiffness and damping of contact.  It has no pattern; what it couples may change with every matrix,
/// and costs no symbolic analysis.
///
/// Points of two soft bodies feel their difference alone: `relative` sums have row sums of zero, and products
/// with them take the nodes' motions against that of the first node, so that rounding acts on differences
/// (as in zero_row_sum_matrix.h).
struct PointStiffness {
  static constexpr int kMostNodes = 8;  ///< four of each side
  /// of the nodes; zero beyond their count
  using Weights = Eigen::Matrix<double, kMostNodes, 1>;
  /// The nodes that one sum couples.
  struct Nodes {
    int count = 0;                       ///< how many there are
    bool relative = false;               ///< row sums are zero: rigid translations feel nothing
    std::array<int, kMostNodes> node{};  ///< over all node blocks; one may stand there twice
  };
  /// The motion of one point, sum w_i x_i: block (i, j) is w_i w_j C.
  struct OfPoint {
    Nodes nodes;                       ///< that carry the point
    Weights weight = Weights::Zero();  ///< w_i, of each node
    Mat3 C = Mat3::Zero();             ///< symmetric, positive semi-definite [N/m]
  };
  std::vector<OfPoint> points;  ///< the sums

  /// Whether there are no sums.
  bool empty() const { return points.empty(); }
  /// Takes all sums out; memory is kept.
  void clear() { points.clear(); }
};

}  // namespace palpate::dynamics
