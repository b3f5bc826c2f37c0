#pragma once
#include <vector>

#include "integrate/linear/cluster_team.h"
#include "integrate/linear/node_kernels.h"
#include "palpate/dynamics/linear_solver.h"

namespace palpate::integrate {

/// Vectors over the nodes, four numbers a node (node_kernels.h), in the order's numbering.
using Singles = std::vector<float>;
using Doubles = std::vector<double>;

/// A symmetric step matrix in single precision with the inverses of its diagonal blocks, nodes in clusters, and its product in double precision beside it.  Made
/// from a matrix in double, which stays where it is and is read by those products; or written by its makers as a BalancedMatrix, and then no other is needed.
class SingleMatrix {
 public:
  SingleMatrix(const NodeKernels& kernels, ClusterTeam& team) : kernels_(kernels), team_(team) {}

  /// Order, rows and memory for a pattern.
  void analyse(const dynamics::BlockSparse& pattern, int clusters);
  bool analysed(const dynamics::BlockSparse& pattern) const { return pattern_version_ != 0 && pattern_version_ == pattern.pattern_version(); }

  /// The copy, and in the same reading to[k] = A from[k] for `count` columns.
  dynamics::SolveStatus take(const dynamics::BorderedMatrix& A, int count, const Doubles* from, Doubles* to);
  /// Room for a balanced matrix of the pattern.  Its memory is set aside at the first call.
  dynamics::BalancedMatrix& room(const dynamics::BlockSparse& pattern);
  /// The matrix that was written there.
  dynamics::SolveStatus take_balanced(int count, const Doubles* from, Doubles* to);
  /// to[k] = A from[k], in double.
  void multiply(int count, const Doubles* from, Doubles* to) { good_of(count, from, to, nullptr, false); }

  const NodeOrder& order() const { return order_; }
  int nodes() const { return static_cast<int>(order_.node.size()); }
  SingleBlocks blocks() const { return {row_start_.data(), column_.data(), written_.values.data()}; }
  int block_count() const { return static_cast<int>(column_.size()); }
  const float* inverse() const { return inverse_.data(); }
  double scale() const { return written_.scale; }  ///< a power of two: the copy is scale A
  /// 1 + h^2 tr K / tr M of a balanced matrix: mean stiffness of a node, over its mass.
  double stiffness() const { return stiffness_; }

 private:
  bool good_of(int count, const Doubles* from, Doubles* to, float* copy, bool balance);
  bool invert(const double* values, const int* slot, double scale);
  void hold(int count, const Doubles* from, Doubles* to);
  BalancedBlocks balanced_blocks();

  const NodeKernels& kernels_;
  ClusterTeam& team_;
  std::uint64_t pattern_version_ = 0;
  NodeOrder order_;
  std::vector<int> place_of_node_, row_start_, column_;
  std::vector<int> source_, diagonal_slot_;  ///< slots of the original
  const dynamics::BorderedMatrix* original_ = nullptr;  ///< null: balanced
  dynamics::BalancedMatrix written_;         ///< its values are the copy of either kind
  std::vector<int> mirror_;                  ///< place of (j, i) for each (i, j)
  Doubles mass_, own_;
  Singles inverse_;
  double stiffness_ = 1.0;
  std::vector<char> good_;
};

}  // namespace palpate::integrate
