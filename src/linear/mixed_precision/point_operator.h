#pragma once
#include <Eigen/Cholesky>
#include <vector>

#include "linear/mixed_precision/node_order.h"
#include "linear/mixed_precision/point_blocks.h"
#include "palpate/dynamics/sparse_border.h"

namespace palpate::linear {

/// Operator form of a PointStiffness, added to the products of a packed matrix, in that matrix's units
/// (scaled by a power of two) and in the order's numbering: products with vectors of four numbers per node,
/// on the rows of one part at a time. It is a separate block matrix, rebuilt with each matrix: contact
/// couples some hundred nodes, where a body has 60,000 blocks.
///
/// Rigid blocks are eliminated: the operator is C - B S^-1 B^T, with the symmetric part of a SparseBorder. It
/// is applied as it stands, since its blocks would couple each node in contact with all others.
///
/// Each part writes only its rows: no barrier is needed, and results do not depend on the number of threads.
/// For that, each part that has rows computes B^T p itself.
class PointOperator {
 public:
  /// Builds the operator. Returns false where S is not positive definite.
  /// @param place_of_node  Index of each node in the order's numbering.
  /// @param scale  Scale of the packed matrix.
  bool take(const dynamics::PointStiffness& points, const dynamics::SparseBorder& border,
            const std::vector<int>& place_of_node, const NodeOrder& order, double scale);
  /// Makes the operator zero.
  void clear();
  bool empty() const { return diagonal_.empty(); }

  /// q += C p on the rows of a part, C in single precision, times `scale`; returns the part's share of
  /// p . C p.
  /// @pre The fourth numbers of p are finite.
  double product(std::size_t part, const float* p, float* q) const;
  /// y += C x on the rows of a part, unscaled and in double.
  void product(std::size_t part, const double* x, double* y) const;

  /// Contribution to a diagonal block, times `scale`; one per node, in the order of the nodes.
  struct Diagonal {
    int node;
    Eigen::Matrix3f block;
  };
  const std::vector<Diagonal>& diagonal() const { return diagonal_; }

  /// Calls visit(node i, node j, block C_ij), without rigid blocks, for all pairs of nodes that the operator
  /// couples, including i = j, each ordered pair once; blocks are times `scale`.
  template <class Visit>
  void for_each_block(Visit&& visit) const {
    for (std::size_t row = 0; row < diagonal_.size(); ++row) {
      visit(diagonal_[row].node, diagonal_[row].node, own_[row]);
      for (auto s = static_cast<std::size_t>(row_start_[row]);
           s < static_cast<std::size_t>(row_start_[row + 1]); ++s)
        visit(diagonal_[row].node, column_[s], Eigen::Matrix3f(single_[s].topRows<3>()));
    }
  }

 private:
  /// Block padded to columns of four numbers, the last one zero: one vector multiplication per column.
  using SingleBlock = Eigen::Matrix<float, 4, 3>;

  /// Takes B and S^-1; returns false where S is not positive definite.
  bool take_border(const dynamics::SparseBorder& border, const std::vector<int>& place_of_node, double scale);
  /// Computes S^-1 B^T p.
  template <class Scalar>
  void rigid_motion(std::size_t part, const Scalar* p, double* motion) const;
  /// Builds the block rows from blocks_.
  void order_rows(double scale);
  /// Finds the rows of each part.
  void find_parts(const NodeOrder& order);

  PointBlocks blocks_;
  std::vector<Diagonal> diagonal_;
  std::vector<int> row_start_, column_, part_start_;  ///< part_start_: first row of each part; parts + 1
  std::vector<int> next_;                             ///< scratch memory of order_rows()
  std::vector<SingleBlock> single_, single_sum_;      ///< C_ij by row, and M_i
  std::vector<Mat3> double_, double_sum_;
  std::vector<Eigen::Matrix3f> own_;  ///< C_ii by row
  Eigen::Index border_ = 0;           ///< Columns of B.
  /// B by row and column, times `scale`, each column of a row padded to four numbers, the last one zero.
  std::vector<Eigen::Vector4f> single_border_;
  std::vector<Vec3> double_border_;
  MatX S_, S_inverse_;  ///< Times `scale` and its inverse.
  Eigen::LLT<MatX> llt_;
  double scale_ = 1.0;
  mutable std::vector<double> motion_;         ///< S^-1 B^T p per part.
  mutable std::vector<Eigen::Vector4f> sums_;  ///< B^T p per part, each number in four summands.
  mutable std::vector<double> double_sums_;    ///< As above, in double.
};

}  // namespace palpate::linear
