#pragma once
#include "integrate/linear/matrix_age.h"
#include "integrate/linear/single_solve.h"

namespace palpate::integrate {

/// Solves by the matrix of an earlier step.  With Ao for the copy and A for what is to be solved, A x = b is Ao x = b - A x + Ao x: where x on the right is an approximation, a
/// system with the copy for a better one, whose error is A^-1 (Ao - A) of the correction (matrix_age.h).  Ao x needs no product: it is the right-hand side less what
/// the iteration left of it.
class NearSolve : public SingleSolve {
 public:
  NearSolve(const NodeKernels& kernels, ClusterTeam& team, SingleMatrix& copy, const RigidClusters& clusters, double rtol, dynamics::SolverCounters& counters)
      : SingleSolve(kernels, team, copy, clusters, rtol, counters), age_(rtol) {}

  void prepare();
  /// The copy is of a new matrix.
  void renew() { age_.renew(); }
  dynamics::SolveStatus solve(const double* b, double* x, bool remember);
  /// x = A^-1 b for a matrix near the copy, which was solved with; counts in solve_s what is not the residual's.  Anything but kOk: it is not near enough.
  dynamics::SolveStatus solve_near(dynamics::Residual& left, VecX& x);

 private:
  dynamics::SolveStatus approach(dynamics::Residual& left, VecX& x);
  void look(dynamics::Residual& left, VecX& x);
  dynamics::SolveStatus mend(double solution, double& stale, double& open);
  dynamics::SolveStatus descend(double start, double rtol, double& open);

  MatrixAge age_;
  Doubles before_;
  VecX residual_;
  double residuals_s_ = 0.0;
};

}  // namespace palpate::integrate
