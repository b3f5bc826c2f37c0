#pragma once
#include "linear/mixed_precision/matrix_age.h"
#include "linear/mixed_precision/single_solve.h"

namespace palpate::linear {

/// Solves by the matrix of an earlier step.  With Ao for the copy and A for what is to be solved, A x = b is
/// Ao x = b - A x + Ao x: where x on the right is an approximation, a system with the copy for a better one,
/// whose error is A^-1 (Ao - A) of the correction (matrix_age.h).  Ao x needs no product: it is the
/// right-hand side less what the iteration left of it.
///
/// In the same way it solves by a copy of the step's own matrix whose rounding is too coarse for a solution,
/// but not for a correction: that every correction leaves is looked at.
class NearSolve : public SingleSolve {
 public:
  NearSolve(const NodeKernels& kernels, ClusterTeam& team, SingleMatrix& copy, const RigidClusters& clusters,
            double rtol, dynamics::SolverCounters& counters)
      : SingleSolve(kernels, team, copy, clusters, rtol, counters), age_(rtol) {}

  void prepare();
  /// The copy is of a new matrix.  @param rounded  too coarsely for a solution: solve_near() is what solves
  /// it
  void renew(bool rounded = false) {
    age_.renew();
    rounded_ = own_ = rounded;
  }
  /// Whether there is something that solves with a rounded copy can begin with.
  bool can_correct() const { return start_.count() > 0 && !iteration_.first(); }
  dynamics::SolveStatus solve(const double* b, double* x, bool remember);
  /// x = A^-1 b for a matrix near the copy, which was solved with, or for that of a rounded copy; counts in
  /// solve_s what is not the residual's.  Anything but kOk: it is not near enough.
  dynamics::SolveStatus solve_near(dynamics::Residual& left, VecX& x);

 private:
  dynamics::SolveStatus approach(dynamics::Residual& left, VecX& x);
  void look(dynamics::Residual& left, VecX& x);
  KrylovStart::Start begin_where_it_leaves();
  template <class Set>
  dynamics::SolveStatus descend(double start, double rtol, double& open, Set&& set_residual);
  dynamics::SolveStatus mend(double solution, double& stale, double& open);

  MatrixAge age_;
  bool rounded_ = false, own_ = false;  ///< the next one is the copy's own
  VecX residual_;                       ///< what a look saw, in the equations' order
  Singles open_;                        ///< what an iteration before the last one left open
  double residuals_s_ = 0.0;
};

}  // namespace palpate::linear
