#pragma once
#include <vector>

#include "integrate/linear/krylov_start.h"
#include "integrate/linear/single_iteration.h"

namespace palpate::integrate {

/// One right-hand side after another, for the matrix that a SingleMatrix holds: conjugate gradients in single precision, right in double (single_pcg.cpp).
class SingleSolve {
 public:
  SingleSolve(const NodeKernels& kernels, ClusterTeam& team, SingleMatrix& copy, const RigidClusters& clusters, double rtol, dynamics::SolverCounters& counters);

  /// Memory for the copy's order.
  void prepare();
  /// What solves start from.
  KrylovStart& start() { return start_; }
  /// x = A^-1 b, 3 a node.  @param remember  as a solution to start from
  dynamics::SolveStatus solve(const double* b, double* x, bool remember);
  /// Of the last solution that is remembered, what those before did not foresee, over the whole, in the energy norm.
  double correction() const { return correction_; }

 protected:
  static constexpr int kIterationLimit = 1000;
  /// Single precision keeps a recurrence honest over so much of a reduction; then the residual is computed anew, in double.
  static constexpr double kReductionInSingle = 1e-4;

  int nodes() const { return copy_.nodes(); }
  /// x_ in the order and shape of its caller; returns its largest number.
  double put_solution(double* x);
  /// r = (b - A x) / size in single precision, with Ax_ at hand; size, so that r is of order one.
  void set_residual();
  double norm_of_residual() const;
  /// Energies of the copy's problem (A scale) d = (b - A x)/size in units of the matrix's own: |x|_A^2 = scale size^2 |d|^2.
  double unit() const { return copy_.scale() * size_ * size_; }
  /// x_ with what the iteration found.
  void add_correction();
  /// Ax_ of what the iteration came to.
  void follow_product();

  const NodeKernels& kernels_;
  ClusterTeam& team_;
  SingleMatrix& copy_;
  double rtol_;
  dynamics::SolverCounters& counters_;
  KrylovStart start_;
  SingleIteration iteration_;
  Doubles b_, x_, Ax_;  ///< in the copy's order
  double size_ = 0.0;
  double correction_ = 0.0;

 private:
  dynamics::SolveStatus iterate(bool warm);
  dynamics::SolveStatus refine();
  bool at_rounding() const;

  std::vector<double> largest_, held_;  ///< of b: of each part; where it stands alone
};

}  // namespace palpate::integrate
