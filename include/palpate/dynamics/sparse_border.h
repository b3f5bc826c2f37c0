#pragma once
#include <vector>

#include "palpate/core/types.h"

namespace palpate::dynamics {

/// Rows and columns of rigid blocks in a step matrix, as BorderedMatrix, for blocks that are coupled to few
/// nodes:
///     [ A       right  ]
///     [ bottom  corner ]
/// Only nodes in contact have entries in `right` and `bottom`. As for PointStiffness, they may be others with
/// every matrix.
class SparseBorder {
 public:
  /// Coupling of a node with one rigid block of six velocities.
  struct Entry {
    int node;                            ///< Node number, over all node blocks.
    int column;                          ///< First of the block's columns in the border.
    Eigen::Matrix<double, 3, 6> right;   ///< Rows of the node.
    Eigen::Matrix<double, 6, 3> bottom;  ///< Rows of the rigid block.
    int next;                            ///< Index of the node's next entry; -1: none.
  };

  MatX corner;  ///< size() x size()

  /// Returns the number of velocities of rigid blocks.
  int size() const { return static_cast<int>(corner.rows()); }
  /// Returns whether there are no rigid blocks.
  bool empty() const { return corner.size() == 0; }
  /// Returns the entries of all nodes.
  const std::vector<Entry>& entries() const { return entries_; }
  /// Sets the sizes, and all values to zero; memory is kept.
  void reset(int node_count, int size);
  /// Returns the entry of a node and a rigid block; a new one is zero.
  Entry& at(int node, int column);
  /// Adds y += by right x_b on the rows of the nodes. Both vectors contain all rows, those of the nodes
  /// first.
  void add_right_product(const VecX& x, double by, VecX& y) const;
  /// Adds y_b += by bottom x_n. x contains the rows of the nodes, y_b only those of the border.
  void add_bottom_product(const VecX& x, double by, VecX& y_b) const;

 private:
  std::vector<Entry> entries_;
  std::vector<int> first_;  ///< First entry of each node; -1: none.
};

}  // namespace palpate::dynamics
