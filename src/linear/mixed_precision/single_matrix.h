#pragma once
#include <vector>

#include "linear/mixed_precision/cluster_team.h"
#include "linear/mixed_precision/node_kernels.h"
#include "linear/mixed_precision/point_operator.h"
#include "linear/mixed_precision/row_packing.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::linear {

/// Vectors over the nodes, four numbers a node (node_kernels.h), in the order's numbering.
using Singles = std::vector<float>;
using Doubles = std::vector<double>;

/// A symmetric step matrix in single precision with the inverses of its diagonal blocks, nodes in clusters,
/// and its product in double precision beside it.  Made from a matrix in double, which stays where it is and
/// is read by those products; or written by its makers as a ZeroRowSumMatrix, and then no other is needed.
class SingleMatrix {
 public:
  SingleMatrix(const NodeKernels& kernels, ClusterTeam& team) : kernels_(kernels), team_(team) {}

  /// Order, rows and memory for a pattern.
  void analyse(const dynamics::BlockSparse& pattern, const NodeOrderSizes& sizes);
  bool analysed(const dynamics::BlockSparse& pattern) const {
    return pattern_version_ != 0 && pattern_version_ == pattern.pattern_version();
  }

  /// The copy, and to[k] = scale A from[k] for `count` columns, in single precision.
  dynamics::SolveStatus take(const dynamics::BorderedMatrix& A, int count, Singles* from, Singles* to);
  /// Room for a zero-row-sum matrix of the pattern.  Its memory is set aside at the first call.
  dynamics::ZeroRowSumMatrix& room(const dynamics::BlockSparse& pattern);
  /// take() of the matrix that was written there.  Held entries of `from` become zero.
  dynamics::SolveStatus take_step_matrix(int count, Singles* from, Singles* to);
  /// The step matrix with the points that are written there now.
  void renew_points();
  /// to[k] = scale A from[k], in single precision.
  void multiply(int count, const Singles* from, Singles* to);
  /// Ax = A x, in double.
  void multiply(const Doubles& x, Doubles& Ax);

  const NodeOrder& order() const { return order_; }
  int nodes() const { return static_cast<int>(order_.node.size()); }
  /// q = A p on the rows of a part, in single precision; returns p . q.
  double product(std::size_t part, const float* p, float* q) const;
  const RowPacking& packing() const { return packing_; }
  const std::vector<int>& row_start() const { return row_start_; }
  const std::vector<int>& column() const { return column_; }
  int block_count() const { return static_cast<int>(column_.size()); }
  const float* inverse() const { return inverse_.data(); }
  bool zero_row_sum() const { return !original_; }
  double scale() const { return written_.scale; }  ///< a power of two: the copy is scale A
  /// 1 + h^2 tr K / tr M of a zero-row-sum matrix: mean stiffness of a node, over its mass.
  double stiffness() const { return stiffness_; }
  /// What stands beside the pattern of a zero-row-sum matrix; empty of a whole one.
  const PointOperator& points() const { return points_; }
  /// The largest stiffness that a node has from there, over its own.
  double point_stiffness() const { return point_stiffness_; }
  /// Entries of vectors, four a node, of which a zero-row-sum matrix says that each stands alone; none of a
  /// whole one.
  const std::vector<std::size_t>& held() const { return held_; }
  /// Moves held entries of a part: values[h] becomes the entry held()[h] of v, and that entry zero.
  void take_held(std::size_t part, double* v, double* values) const;

 private:
  PackedRows rows(std::size_t part) const {
    return packing_.rows(part, original_ ? nullptr : mass_single_.data());
  }
  void multiply(std::size_t part, int count, const Singles* from, Singles* to);
  template <class Real>
  void zero_held(std::size_t part, Real* v) const;
  void find_held();
  void hold(std::size_t part);
  void add_points_to_inverse();
  Eigen::Matrix3f own_block(std::size_t node) const;
  void store_inverse(std::size_t node, const Eigen::Matrix3f& block);

  const NodeKernels& kernels_;
  ClusterTeam& team_;
  std::uint64_t pattern_version_ = 0;
  NodeOrder order_;
  std::vector<int> place_of_node_, row_start_, column_;
  std::vector<int> source_, diagonal_slot_;  ///< slots of the original
  mutable RowPacking packing_;
  const dynamics::BorderedMatrix* original_ = nullptr;  ///< null: a zero-row-sum matrix
  Singles copy_;                                        ///< of a whole matrix, on the way to its packing
  std::vector<int> copy_offset_;
  dynamics::ZeroRowSumMatrix written_;
  std::vector<int> written_offset_;
  std::vector<std::uint16_t> transposed_;
  std::vector<std::size_t> held_, held_start_;  ///< by part
  Doubles mass_;
  Singles mass_single_, sums_, inverse_;
  PointOperator points_;
  double stiffness_ = 1.0, point_stiffness_ = 0.0;
  std::vector<char> good_;
  std::vector<RowStatus> row_status_;
  std::vector<double> trace_, mass_trace_;
};

}  // namespace palpate::linear
