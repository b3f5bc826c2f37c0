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
  /// Number of nodes.
  int block_rows() const { return static_cast<int>(row_start_.size()) - 1; }
  /// Number of stored blocks.
  int slot_count() const { return static_cast<int>(columns_.size()); }
  /// Where the blocks of each row start; one more than rows.
  const std::vector<int>& row_start() const { return row_start_; }
  /// Column of each block; ascending in a row.
  const std::vector<int>& columns() const { return columns_; }
  /// Nine numbers a block; whoever writes them must call BorderedMatrix::touch().
  std::vector<double>& values() { return values_; }
  /// Nine numbers a block.
  const std::vector<double>& values() const { return values_; }

  /// Index of block (i, j) in columns(), -1 when it is not in the pattern.  O(log row length).
  int slot(int i, int j) const;
  /// Slot of block (i, i), O(1).
  int diagonal(int i) const { return diagonal_[static_cast<std::size_t>(i)]; }
  /// The nine numbers of a block.
  double* block(int slot) { return values_.data() + 9 * static_cast<std::size_t>(slot); }
  /// The nine numbers of a block.
  const double* block(int slot) const { return values_.data() + 9 * static_cast<std::size_t>(slot); }
  /// Adds a 3x3 block.
  void add(int slot, const Mat3& m) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(block(slot)) += m;
  }
  /// All values become 0; the pattern stays.
  void set_zero() { set_zero(0, block_rows()); }
  /// The values of some rows become 0.
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
  /// @param node_count  of all node blocks; nodes are counted over them
  explicit PatternBuilder(int node_count) : node_count_(node_count) {}
  /// Over all node blocks of a layout; a term finds its own block's place with first_node().
  explicit PatternBuilder(const Layout& layout) : node_count_(layout.node_count()), layout_(&layout) {}
  /// First node of a node block, counted over all node blocks; 0 where the builder was made without a layout.
  int first_node(int block_id) const;
  void add_pair(int i, int j);                   ///< (i, j) and (j, i)
  void add_clique(const int* nodes, int count);  ///< every pair of them
  /// The pattern so far, values 0.
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
  BlockSparse body;  ///< the sparse part
  MatX right;        ///< nodal_size x border
  MatX bottom;       ///< border x nodal_size
  MatX corner;       ///< border x border
  /// of the nodes [m], three numbers each, for preconditioners that know rigid motions; empty: not known
  VecX positions;
  bool symmetric = true;  ///< whether A = A^T; what a term adds must agree with it
  /// grows with every change of values; equal versions and patterns mean an equal matrix
  std::uint64_t values_version = 0;

  /// Rows of `body`.
  int nodal_size() const { return 3 * body.block_rows(); }
  /// Rows of the border.
  int border_size() const { return static_cast<int>(corner.rows()); }
  /// Rows of all.
  int size() const { return nodal_size() + border_size(); }
  /// All values become 0; the pattern and the sizes stay.
  void set_zero();
  void touch();  ///< gives values_version a fresh, process-wide unique value
  /// y = A x; y is resized.
  void multiply(const VecX& x, VecX& y) const;
  MatX to_dense() const;  ///< tests and small systems
};

}  // namespace palpate::dynamics
