#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "palpate/core/types.h"
#include "palpate/dynamics/layout.h"

namespace palpate::dynamics {

/// Sparse matrix of 3x3 blocks over the nodes, both triangles stored, rows compressed, columns ascending.
/// Values are row-major inside a block: entry (r, c) of block s is values[9 s + 3 r + c].
class BlockSparse {
 public:
  int block_rows() const { return static_cast<int>(row_start_.size()) - 1; }
  int slot_count() const { return static_cast<int>(columns_.size()); }
  const std::vector<int>& row_start() const { return row_start_; }
  const std::vector<int>& columns() const { return columns_; }
  std::vector<double>& values() { return values_; }
  const std::vector<double>& values() const { return values_; }

  /// Index of block (i, j) in columns(), -1 when it is not in the pattern.  O(log row length).
  int slot(int i, int j) const;
  /// Slot of block (i, i), O(1).
  int diagonal(int i) const { return diagonal_[static_cast<std::size_t>(i)]; }
  double* block(int slot) { return values_.data() + 9 * static_cast<std::size_t>(slot); }
  const double* block(int slot) const { return values_.data() + 9 * static_cast<std::size_t>(slot); }
  void add(int slot, const Mat3& m) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(block(slot)) += m;
  }
  void set_zero() { set_zero(0, block_rows()); }
  void set_zero(int first_row, int rows);
  /// y += A x
  void multiply_add(const double* x, double* y) const;
  /// y += A^T x
  void multiply_transposed_add(const double* x, double* y) const;

  /// Grows whenever the pattern is rebuilt: symbolic analyses and scatter maps made for another version are
  /// stale.  Unique over all matrices of the process.
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

/// Node pairs, both ways round, ascending, each once.
using NodePairs = std::vector<std::pair<int, int>>;
/// Into that order, duplicates removed.  Linear in their number, for pairs spread over the nodes.
/// @pre 0 <= first < node_count of each
void sort_unique(NodePairs& pairs, int node_count);

/// Collects which node pairs interact; diagonal blocks are always in.
class PatternBuilder {
 public:
  explicit PatternBuilder(int node_count) : node_count_(node_count) {}
  /// Over all node blocks of a layout; a term finds its own block's place with first_node().
  explicit PatternBuilder(const Layout& layout) : node_count_(layout.node_count()), layout_(&layout) {}
  /// First node of a node block, counted over all node blocks; 0 where the builder was made without a layout.
  int first_node(int block_id) const;
  void add_pair(int i, int j);                   ///< (i, j) and (j, i)
  void add_clique(const int* nodes, int count);  ///< every pair of them
  BlockSparse build() const;
  NodePairs pairs() const;  ///< what was added

 private:
  int node_count_;
  const Layout* layout_ = nullptr;
  NodePairs pairs_;  ///< as they came
};

/// The pattern of some lists together, and of the diagonal: what a PatternBuilder builds that was given all
/// of them, without sorting them anew.
BlockSparse pattern_of(int node_count, const std::vector<const NodePairs*>& lists);

/// The matrix of one implicit step in u-space: a sparse body part over the nodes, bordered by dense rows and
/// columns of rigid and articulated blocks.
///     [ body    right  ]   nodal_size
///     [ bottom  corner ]   border_size
struct BorderedMatrix {
  BlockSparse body;
  MatX right;   ///< nodal_size x border
  MatX bottom;  ///< border x nodal_size
  MatX corner;  ///< border x border
  /// of the nodes [m], three numbers each, for preconditioners that know rigid motions; empty: not known
  VecX positions;
  bool symmetric = true;
  /// grows with every change of values; equal versions and patterns mean an equal matrix
  std::uint64_t values_version = 0;

  int nodal_size() const { return 3 * body.block_rows(); }
  int border_size() const { return static_cast<int>(corner.rows()); }
  int size() const { return nodal_size() + border_size(); }
  void set_zero();
  void touch();  ///< gives values_version a fresh, process-wide unique value
  void multiply(const VecX& x, VecX& y) const;
  MatX to_dense() const;  ///< tests and small systems
};

}  // namespace palpate::dynamics
