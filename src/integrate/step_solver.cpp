#include "integrate/step_solver.h"

namespace palpate::integrate {

using dynamics::BorderedMatrix;
using dynamics::SolveStatus;

SolveStatus StepSolver::factor_chosen(const BorderedMatrix& A) {
  matrix_ = &A;
  projected_ = false;
  const long before = counters().factorisations;
  const SolveStatus status = solvers_.factor(A);
  if (solvers_.by_chosen() && status == SolveStatus::kIndefinite)
    indefinite_count_ += counters().factorisations - before;
  if (status == SolveStatus::kNotConverged) ++unconverged_count_;
  return status;
}

SolveStatus StepSolver::factor_projected(const BorderedMatrix& A) {
  matrix_ = &A;
  projected_ = true;
  const SolveStatus status = solvers_.factor(A);
  if (status == SolveStatus::kOk) ++projected_count_;
  return status;
}

SolveStatus StepSolver::factor_direct(const BorderedMatrix& A) {
  matrix_ = &A;
  projected_ = false;
  return solvers_.factor_direct(A);
}

SolveStatus StepSolver::solve_symmetric(const VecX& b, VecX& x) {
  const bool by_chosen = solvers_.by_chosen();
  SolveStatus status = solvers_.solve(b, x);
  if (!by_chosen) return status;
  if (status == SolveStatus::kNotConverged) {
    ++unconverged_count_;
    status = matrix_->symmetric ? solvers_.factor_by_cholesky(*matrix_) : solvers_.factor_by_lu(*matrix_);
    if (status == SolveStatus::kOk) return solvers_.solve(b, x);
  }
  if (status == SolveStatus::kIndefinite && !projected_) ++indefinite_count_;
  return status;
}

void StepSolver::report(dynamics::StepperCounters& counters) const {
  counters.solver = solvers_.counters();
  counters.indefinite = indefinite_count_;
  counters.projected = projected_count_;
  counters.unconverged = unconverged_count_;
  counters.lu = solvers_.left_to_lu();
}

}  // namespace palpate::integrate
