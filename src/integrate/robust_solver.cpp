#include "integrate/robust_solver.h"

namespace palpate::integrate {

using dynamics::SolveStatus;

SolveStatus RobustSolver::factor(const dynamics::BorderedMatrix& A) {
  matrix_ = &A;
  const SolveStatus status = solvers_.factor(A);
  if (status != SolveStatus::kIndefinite && status != SolveStatus::kNotConverged) return status;
  return solvers_.factor_direct(A);
}

template <class Columns>
SolveStatus RobustSolver::solve_columns(const Columns& b, Columns& x, Columns& kept) {
  if (!solvers_.by_chosen() || !matrix_) return solvers_.solve(b, x);
  const bool in_place = &b == &x;
  if (in_place) kept = b;
  const SolveStatus status = solvers_.solve(b, x);
  if (status != SolveStatus::kIndefinite && status != SolveStatus::kNotConverged) return status;
  if (const SolveStatus direct = solvers_.factor_direct(*matrix_); direct != SolveStatus::kOk) return direct;
  return solvers_.solve(in_place ? kept : b, x);
}

}  // namespace palpate::integrate
