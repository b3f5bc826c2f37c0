#pragma once
#include <vector>

#include "linear/mixed_precision/cluster_team.h"
#include "linear/mixed_precision/node_kernels.h"
#include "linear/mixed_precision/point_operator.h"
#include "linear/mixed_precision/row_packing.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::linear {

/// Vectors over the nodes, four numbers per node (node_kernels.h), in the order's numbering.
using Singles = std::vector<float>;
using Doubles = std::vector<double>;

/// Symmetric step matrix in single precision with the inverses of its diagonal blocks and its nodes ordered
/// in clusters, together with a product in double precision. The source is either a matrix in double, which
/// must stay valid and is read by those products, or a ZeroRowSumMatrix that its assembler writes directly;
/// the latter needs no original.
class SingleMatrix {
 public:
  SingleMatrix(const NodeKernels& kernels, ClusterTeam& team) : kernels_(kernels), team_(team) {}

  /// Computes the order, the packing and the memory for a pattern.
  void analyse(const dynamics::BlockSparse& pattern, const NodeOrderSizes& sizes);
  bool analysed(const dynamics::BlockSparse& pattern) const {
    return pattern_version_ != 0 && pattern_version_ == pattern.pattern_version();
  }

  /// Copies A, and computes to[k] = scale A from[k] for `count` columns, in single precision. Returns
  /// kSingular if a value is not finite, kIndefinite if a diagonal block is not positive definite.
  dynamics::SolveStatus take(const dynamics::BorderedMatrix& A, int count, Singles* from, Singles* to);
  /// Returns the storage of a zero-row-sum matrix of the pattern. Its memory is allocated at the first call.
  dynamics::ZeroRowSumMatrix& room(const dynamics::BlockSparse& pattern);
  /// Prepares the matrix written to room(), otherwise as take(). Held entries of `from` become zero.
  dynamics::SolveStatus take_step_matrix(int count, Singles* from, Singles* to);
  /// Returns the step matrix last written; its points and border may be rewritten before renew_points().
  dynamics::ZeroRowSumMatrix& written() { return written_; }
  /// Replaces the points and the border of the step matrix by those now in written(), and their part of
  /// to[k] = scale A from[k]. Returns false where the border's corner is not positive definite.
  bool renew_points(int count, Singles* from, Singles* to);
  /// to[k] = scale A from[k], in single precision.
  void multiply(int count, const Singles* from, Singles* to);
  /// Ax = A x, in double.
  void multiply(const Doubles& x, Doubles& Ax);

  const NodeOrder& order() const { return order_; }
  int nodes() const { return static_cast<int>(order_.node.size()); }
  /// q = scale A p on the rows of a part, in single precision; returns p . q.
  double product(std::size_t part, const float* p, float* q) const;
  const RowPacking& packing() const { return packing_; }
  const std::vector<int>& row_start() const { return row_start_; }
  const std::vector<int>& column() const { return column_; }
  int block_count() const { return static_cast<int>(column_.size()); }
  const float* inverse() const { return inverse_.data(); }
  bool zero_row_sum() const { return !original_; }
  double scale() const { return written_.scale; }  ///< power of two: the copy is scale A
  /// 1 + h^2 tr K / tr M of a zero-row-sum matrix: mean ratio of a node's stiffness to its mass.
  double stiffness() const { return stiffness_; }
  /// Points of a zero-row-sum matrix (contact); empty for a whole matrix.
  const PointOperator& points() const { return points_; }
  /// Largest ratio, over the nodes, of stiffness from points to the node's stiffness in the matrix.
  double point_stiffness() const { return point_stiffness_; }
  /// Whether the zero-row-sum matrix has rigid blocks.
  bool bordered() const { return !original_ && !written_.border.empty(); }
  /// Indices of held entries of vectors, four per node; rows and columns of a zero-row-sum matrix are the
  /// identity's there. Empty for a whole matrix.
  const std::vector<std::size_t>& held() const { return held_; }
  /// Moves the held entries of a part: values[h] = v[held()[h]], which then becomes zero.
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
  void add_point_products(float sign, int count, Singles* from, Singles* to);
  Eigen::Matrix3f own_block(std::size_t node) const;
  void store_inverse(std::size_t node, const Eigen::Matrix3f& block);

  const NodeKernels& kernels_;
  ClusterTeam& team_;
  std::uint64_t pattern_version_ = 0;
  NodeOrder order_;
  std::vector<int> place_of_node_, row_start_, column_;
  std::vector<int> source_, diagonal_slot_;  ///< slots of the original matrix
  mutable RowPacking packing_;
  const dynamics::BorderedMatrix* original_ = nullptr;  ///< null: a zero-row-sum matrix
  Singles copy_;                                        ///< copy of a whole matrix, before packing
  std::vector<int> copy_offset_;
  dynamics::ZeroRowSumMatrix written_;
  std::vector<int> written_offset_;
  std::vector<std::uint16_t> transposed_;
  std::vector<std::size_t> held_, held_start_;  ///< held entries, and the first one of each part
  Doubles mass_;
  Singles mass_single_, sums_, inverse_;
  PointOperator points_;
  Singles of_points_;  ///< scratch of add_point_products(), zero between calls
  double stiffness_ = 1.0, point_stiffness_ = 0.0;
  std::vector<char> good_;
  std::vector<RowStatus> row_status_;
  std::vector<double> trace_, mass_trace_;
};

}  // namespace palpate::linear
