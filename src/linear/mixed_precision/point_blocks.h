#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "palpate/dynamics/point_stiffness.h"

namespace palpate::linear {

/// Blocks C_ij of a PointStiffness, one per pair of nodes, as symmetric 3x3 matrices of six numbers.
///
/// A contact has some thousand sums on some hundred nodes, and nearly all of them share their nodes with
/// others. Sums on the same nodes are added up first, then the blocks of each set of nodes over all pairs.
///
/// A block row is (C x)_i = M_i x_i + sum_{j != i} C_ij (x_j - x_i) with M_i = sum_j C_ij. `relative` sums
/// contribute nothing to M: they exert no force under a translation, exactly, not only up to rounding, as in
/// zero_row_sum_matrix.h.
class PointBlocks {
 public:
  using Six = Eigen::Matrix<double, 6, 1>;  ///< xx, yy, zz, yz, zx, xy
  /// Block of a pair of rows.
  struct Pair {
    int i, j;  ///< rows, i < j
    Six C;
  };
  /// Sums up the points.
  /// @param place_of_node  Index of each node in the solver's order.
  void sum(const dynamics::PointStiffness& points, const std::vector<int>& place_of_node);

  const std::vector<int>& places() const { return places_; }  ///< places of the rows, ascending
  const std::vector<Pair>& pairs() const { return pairs_; }
  const std::vector<Six>& row_sums() const { return row_sums_; }  ///< M_i, by row
  /// Packs a symmetric matrix.
  static Six of(const Mat3& C) { return {C(0, 0), C(1, 1), C(2, 2), C(1, 2), C(0, 2), C(0, 1)}; }
  /// Unpacks a symmetric matrix.
  static Mat3 matrix(const Six& c) {
    Mat3 out;
    out << c[0], c[5], c[4], c[5], c[1], c[3], c[4], c[3], c[2];
    return out;
  }

 private:
  using Nodes = dynamics::PointStiffness::Nodes;
  static constexpr int kMost = dynamics::PointStiffness::kMostNodes;
  /// Sum of all points on the same nodes in the same order.
  struct Set {
    Nodes nodes;
    std::array<Six, kMost * kMost> C;  ///< block (i, j), i <= j, at kMost i + j
  };
  /// Returns the set of these nodes, found or added by its hash.
  Set& set_of(const Nodes& nodes);
  /// Replaces nodes by places in all sets and numbers the rows.
  void find_rows(const std::vector<int>& place_of_node);
  /// Returns the block of a pair of rows, found or added.
  Six& pair(int i, int j);

  std::vector<Set> sets_;
  std::size_t set_count_ = 0, last_ = 0;
  std::vector<int> table_;       ///< hash table of sets; -1: empty
  std::vector<int> pair_table_;  ///< hash table of pairs; -1: empty
  std::vector<int> row_;         ///< row of each place; -1: none
  std::vector<int> places_;
  std::vector<Pair> pairs_;
  std::vector<Six> row_sums_;
};

}  // namespace palpate::linear
