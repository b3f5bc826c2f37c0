#pragma once
#include <vector>

#include "linear/mixed_precision/node_order.h"
#include "linear/mixed_precision/point_blocks.h"

namespace palpate::linear {

/// A PointStiffness as an operator beside a packed matrix, in its units (times a power of two) and in the
/// order's numbering: products with vectors of four numbers a node, row ranges of one part at a time.  It is
/// a block matrix of its own, made anew with each matrix: contact couples some hundred nodes where a body has
/// 60,000 blocks.
///
/// Parts write rows of their own: they need no barrier, and results do not depend on the number of threads.
class PointOperator {
 public:
  /// @param place_of_node  in the order's numbering  @param scale  of the packed matrix
  void take(const dynamics::PointStiffness& points, const std::vector<int>& place_of_node,
            const NodeOrder& order, double scale);
  void clear();
  bool empty() const { return diagonal_.empty(); }

  /// q += C p on the rows of a part, C in single precision; returns the part's share of p . C p.
  /// @pre fourth numbers of p are finite
  double product(std::size_t part, const float* p, float* q) const;
  /// y += C x on the rows of a part, unscaled and in double.
  void product(std::size_t part, const double* x, double* y) const;

  /// What it adds to diagonal blocks, each node once, in the order of nodes.
  struct Diagonal {
    int node;
    Eigen::Matrix3f block;
  };
  const std::vector<Diagonal>& diagonal() const { return diagonal_; }

  /// visit(node i, node j, block C_ij) for all pairs of nodes that it couples, each once.
  template <class Visit>
  void for_each_block(Visit&& visit) const {
    for (std::size_t row = 0; row < diagonal_.size(); ++row) {
      visit(diagonal_[row].node, diagonal_[row].node, diagonal_[row].block);
      for (auto s = static_cast<std::size_t>(row_start_[row]);
           s < static_cast<std::size_t>(row_start_[row + 1]); ++s)
        visit(diagonal_[row].node, column_[s], Eigen::Matrix3f(single_[s].topRows<3>()));
    }
  }

 private:
  /// Columns of four numbers, the last one zero: one multiplication a column in vector registers.
  using SingleBlock = Eigen::Matrix<float, 4, 3>;

  void order_rows(double scale);
  void find_parts(const NodeOrder& order);

  PointBlocks blocks_;
  std::vector<Diagonal> diagonal_;
  std::vector<int> row_start_, column_, part_start_;  ///< part_start_: first row of each part, and the last
  std::vector<int> next_;                             ///< scratch of order_rows
  std::vector<SingleBlock> single_, single_sum_;      ///< C_ij by row, and M_i
  std::vector<Mat3> double_, double_sum_;
};

}  // namespace palpate::linear
