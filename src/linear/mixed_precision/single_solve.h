#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "linear/mixed_precision/krylov_start.h"
#include "linear/mixed_precision/single_iteration.h"

namespace palpate::linear {

/// One right-hand side after another, for the matrix that a SingleMatrix holds: conjugate gradients in single
/// precision, right in double (single_pcg.cpp).
class SingleSolve {
 public:
  SingleSolve(const NodeKernels& kernels, ClusterTeam& team, SingleMatrix& copy,
              const RigidClusters& clusters, double rtol, dynamics::SolverCounters& counters);

  /// Memory for the copy's order.
  void prepare();
  /// What solves start from.
  KrylovStart& start() { return start_; }
  /// x = A^-1 b, 3 a node.  @param remember  as a solution to start from
  dynamics::SolveStatus solve(const double* b, double* x, bool remember);
  /// Of the last solution that is remembered, what those before did not foresee, over the whole, in the
  /// energy norm.
  double correction() const { return correction_; }

 protected:
  static constexpr int kIterationLimit = 1000;
  /// Single precision keeps a recurrence honest over so much of a reduction; then the residual is computed
  /// anew, in double.
  static constexpr double kReductionInSingle = 1e-4;

  int nodes() const { return copy_.nodes(); }
  /// Solutions and products are made a block of nodes at a time, in memory that the cache holds, where nobody
  /// asks for the whole of them.
  static constexpr int kNodesOfBlock = 128;
  using Block = std::array<double, 4 * kNodesOfBlock>;
  /// work(first, last) on blocks of nodes.
  template <class Work>
  static void over_blocks(int first, int last, Work&& work) {
    for (; first < last; first += kNodesOfBlock) work(first, std::min(last, first + kNodesOfBlock));
  }

  /// A new right-hand side; b_ and the sums over it are for the caller to make, part by part.
  void begin(bool warm);
  /// The start and its residual.
  KrylovStart::Start choose();
  /// The iteration's residual: what the start leaves of b_, on nodes [first, last).
  void set_residual(int first, int last) {
    start_.residual(1.0 / size_, b_.data(), iteration_.residual().data(), first, last);
  }
  /// The solution so far on these nodes: there, or in x_ where it is at hand.
  const double* solution(int first, int last, Block& block) const;
  /// The same, into x_, which it is added up in from now on; the iteration may find more.
  void add_correction();
  /// The solution in the order and shape of its caller; returns its largest number.  @param keep  as one to
  /// start from, with its product if `follow`
  double put_solution(double* x, bool keep = false, bool follow = false);
  /// Energies of the copy's problem (A scale) d = (b - A x)/size in units of the matrix's own: |x|_A^2 =
  /// scale size^2 |d|^2.
  double unit() const { return copy_.scale() * size_ * size_; }

  const NodeKernels& kernels_;
  ClusterTeam& team_;
  SingleMatrix& copy_;
  double rtol_;
  dynamics::SolverCounters& counters_;
  KrylovStart start_;
  SingleIteration iteration_;
  Doubles b_;  ///< in the copy's order
  /// where it is `at_hand_`; else the solution is its start and what the iteration found
  Doubles x_;
  bool at_hand_ = false;
  double size_ = 0.0;  ///< the iteration's residual times this is b - A x
  double correction_ = 0.0;

 private:
  dynamics::SolveStatus iterate();
  dynamics::SolveStatus refine();
  void renew_residual();
  bool at_rounding() const;

  Doubles Ax_;                          ///< for products in double
  std::vector<double> largest_, held_;  ///< of b: of each part; where it stands alone
};

}  // namespace palpate::linear
