#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "palpate/dynamics/point_stiffness.h"

namespace palpate::linear {

/// The blocks C_ij of a PointStiffness, each pair of nodes once, as symmetric 3x3 matrices of six numbers.
///
/// A contact has some thousand sums on some hundred nodes: nearly all of them share their nodes with others.
/// Those on the same nodes are summed first, then the blocks of each set of nodes over all pairs.
///
/// A block row is (C x)_i = M_i x_i + sum_{j != i} C_ij (x_j - x_i) with M_i = sum_j C_ij, which `relative`
/// sums have no part in: a translation costs them nothing, not by rounding either, as in
/// zero_row_sum_matrix.h.
class PointBlocks {
 public:
  using Six = Eigen::Matrix<double, 6, 1>;  ///< xx, yy, zz, yz, zx, xy
  struct Pair {
    int i, j;  ///< rows, i < j
    Six C;
  };
  /// @param place_of_node  what nodes are called here
  void sum(const dynamics::PointStiffness& points, const std::vector<int>& place_of_node);

  const std::vector<int>& places() const { return places_; }  ///< of the rows, ascending
  const std::vector<Pair>& pairs() const { return pairs_; }
  const std::vector<Six>& row_sums() const { return row_sums_; }  ///< M, by row
  static Six of(const Mat3& C) { return {C(0, 0), C(1, 1), C(2, 2), C(1, 2), C(0, 2), C(0, 1)}; }
  static Mat3 matrix(const Six& c) {
    Mat3 out;
    out << c[0], c[5], c[4], c[5], c[1], c[3], c[4], c[3], c[2];
    return out;
  }

 private:
  using Nodes = dynamics::PointStiffness::Nodes;
  static constexpr int kMost = dynamics::PointStiffness::kMostNodes;
  /// All sums on the same nodes in the same order.
  struct Set {
    Nodes nodes;
    std::array<Six, kMost * kMost> C;  ///< block (i, j), i <= j, at kMost i + j
  };
  Set& set_of(const Nodes& nodes);
  void find_rows(const std::vector<int>& place_of_node);
  Six& pair(int i, int j);

  std::vector<Set> sets_;
  std::size_t set_count_ = 0, last_ = 0;
  std::vector<int> table_;       ///< sets by the hash of their nodes; -1: none
  std::vector<int> pair_table_;  ///< pairs likewise
  std::vector<int> row_;         ///< of each place; -1: none
  std::vector<int> places_;
  std::vector<Pair> pairs_;
  std::vector<Six> row_sums_;
};

}  // namespace palpate::linear
