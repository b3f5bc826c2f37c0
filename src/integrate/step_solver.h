#pragma once
#include "palpate/dynamics/linear_solver.h"

namespace palpate::integrate {

/// The linear solver of an integrator, with what stands behind it: an LU that is made at the first matrix that the
/// chosen solver cannot take (unsymmetric: "integrate.unsymmetric" is counted; indefinite: indefinite() is counted).
/// An indefinite step matrix is then still the right Newton matrix; it is only no sum of a mass and a stable stiffness.
class StepSolver {
 public:
  explicit StepSolver(std::unique_ptr<dynamics::LinearSolver> chosen);
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A);
  dynamics::SolveStatus solve(const VecX& b, VecX& x) { return active_->solve(b, x); }
  long indefinite() const { return indefinite_; }
  /// Sum over both solvers.
  dynamics::SolverCounters counters() const;

 private:
  dynamics::SolveStatus factor_by_lu(const dynamics::BorderedMatrix& A);
  std::unique_ptr<dynamics::LinearSolver> chosen_, lu_;
  dynamics::LinearSolver* active_;
  long indefinite_ = 0;
};

}  // namespace palpate::integrate
