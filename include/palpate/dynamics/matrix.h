#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "palpate/core/types.h"
#include "palpate/dynamics/layout.h"

namespace palpate::dynamics {

/// Sparse matrix of 3x3 blocks over the nodes (block compressed rows, both triangles stored, columns
/// ascending). Values are row-major inside a block: entry (r, c) of block s is values[9 s + 3 r + c].
class BlockSparse {
 public:
  /// Returns the number of nodes.
  int block_rows() const { return static_cast<int>(row_start_.size()) - 1; }
  /// Returns the number of stored blocks.
  int slot_count() const { return static_cast<int>(columns_.size()); }
  /// Returns the index of the first block of each row, and the total at the end.
  const std::vector<int>& row_start() const { return row_start_; }
  /// Returns the column of each block; ascending within a row.
  const std::vector<int>& columns() const { return columns_; }
  /// Returns the values, nine per block. Whoever writes them must call BorderedMatrix::touch().
  std::vector<double>& values() { return values_; }
  /// Returns the values, nine per block.
  const std::vector<double>& values() const { return values_; }

  /// Returns the index of block (i, j) in columns(), -1 when it is not in the pattern. O(log row length).
  int slot(int i, int j) const;
  /// Returns the slot of block (i, i), O(1).
  int diagonal(int i) const { return diagonal_[static_cast<std::size_t>(i)]; }
  /// Returns the nine values of a block.
  double* block(int slot) { return values_.data() + 9 * static_cast<std::size_t>(slot); }
  /// Returns the nine values of a block.
  const double* block(int slot) const { return values_.data() + 9 * static_cast<std::size_t>(slot); }
  /// Adds a 3x3 matrix to a block.
  void add(int slot, const Mat3& m) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(block(slot)) += m;
  }
  /// Sets all values to 0; the pattern is unchanged.
  void set_zero() { set_zero(0, block_rows()); }
  /// Sets the values of some rows to 0.
  void set_zero(int first_row, int rows);
  /// Adds y += A x.
  void multiply_add(const double* x, double* y) const;
  /// Adds y += A^T x.
  void multiply_transposed_add(const double* x, double* y) const;

  /// Version of the pattern. Increases whenever the pattern is rebuilt; symbolic analyses and scatter maps
  /// made for another version are stale. Unique over all matrices of the process.
  std::uint64_t pattern_version() const { return pattern_version_; }

 private:
  friend BlockSparse pattern_of(int node_count,
                                const std::vector<const std::vector<std::pair<int, int>>*>& lists);
  std::vector<int> row_start_{0};
  std::vector<int> columns_;
  std::vector<int> diagonal_;
  std::vector<double> values_;
  std::uint64_t pattern_version_ = 0;
};

/// Node pairs, each in both orders, ascending, without duplicates.
using NodePairs = std::vector<std::pair<int, int>>;
/// Sorts the pairs into that order and removes duplicates. Linear in their number for pairs spread over the
/// nodes.
/// @pre 0 <= first < node_count for each pair
void sort_unique(NodePairs& pairs, int node_count);

/// Collects which node pairs interact; diagonal blocks are always included.
class PatternBuilder {
 public:
  /// @param node_count  number of nodes of all node blocks; nodes are numbered over all of them
  explicit PatternBuilder(int node_count) : node_count_(node_count) {}
  /// Builds over all node blocks of a layout; a term finds the first node of its block with first_node().
  explicit PatternBuilder(const Layout& layout) : node_count_(layout.node_count()), layout_(&layout) {}
  /// Returns the first node of a node block, numbered over all node blocks; 0 where the builder was made
  /// without a layout.
  int first_node(int block_id) const;
  void add_pair(int i, int j);                   ///< Adds (i, j) and (j, i).
  void add_clique(const int* nodes, int count);  ///< Adds every pair of these nodes.
  /// Returns the pattern of all pairs added so far, values 0.
  BlockSparse build() const;
  NodePairs pairs() const;  ///< Returns the pairs added so far, sorted.

 private:
  int node_count_;
  const Layout* layout_ = nullptr;
  NodePairs pairs_;  ///< Pairs in the order in which they were added.
};

/// Builds the pattern of the union of some sorted lists and the diagonal: the result of a PatternBuilder
/// given all of them, without sorting them again.
BlockSparse pattern_of(int node_count, const std::vector<const NodePairs*>& lists);

/// Matrix of one implicit step in u-space: a sparse body part over the nodes, bordered by dense rows and
/// columns of rigid and articulated blocks.
///     [ body    right  ]   nodal_size
///     [ bottom  corner ]   border_size
struct BorderedMatrix {
  BlockSparse body;  ///< Sparse part over the nodes.
  MatX right;        ///< nodal_size x border_size
  MatX bottom;       ///< border_size x nodal_size
  MatX corner;       ///< border_size x border_size
  /// Nodal positions [m], three numbers each, for preconditioners that use rigid motions; empty: not known.
  VecX positions;
  bool symmetric = true;  ///< Whether A = A^T; the contributions of all terms must agree with it.
  /// Increases with every change of values. Equal versions and patterns imply equal matrices.
  std::uint64_t values_version = 0;

  /// Returns the number of rows of `body`.
  int nodal_size() const { return 3 * body.block_rows(); }
  /// Returns the number of rows of the border.
  int border_size() const { return static_cast<int>(corner.rows()); }
  /// Returns the number of all rows.
  int size() const { return nodal_size() + border_size(); }
  /// Sets all values to 0; the pattern and the sizes are unchanged.
  void set_zero();
  void touch();  ///< Gives values_version a new value, unique in the process.
  /// Computes y = A x; y is resized.
  void multiply(const VecX& x, VecX& y) const;
  MatX to_dense() const;  ///< Returns the dense matrix, for tests and small systems.
};

}  // namespace palpate::dynamics
