#include "integrate/step_solver.h"

#include <type_traits>

#include "palpate/core/counters.h"
#include "palpate/linear/solvers.h"

namespace palpate::integrate {

using dynamics::BorderedMatrix;
using dynamics::SolverCounters;
using dynamics::SolveStatus;

StepSolver::StepSolver(std::unique_ptr<dynamics::LinearSolver> chosen, const IntegratorSpec& spec)
    : chosen_(std::move(chosen)), active_(chosen_.get()), project_(spec.indefinite == "project") {}

SolveStatus StepSolver::factor_by_lu(const BorderedMatrix& A) {
  if (!lu_) lu_ = linear::make_linear_solver("umfpack");
  active_ = lu_.get();
  return lu_->factor(A);
}

SolveStatus StepSolver::factor_by_cholesky(const BorderedMatrix& A) {
  if (!cholesky_) cholesky_ = linear::make_linear_solver("cholmod");
  active_ = cholesky_.get();
  return cholesky_->factor(A);
}

/// By what needs no iteration: a Cholesky factor where there is one, a third of the time of LU, and the
/// chosen solver has not just looked for it.
SolveStatus StepSolver::factor_direct(const BorderedMatrix& A) {
  definite_ = false;
  if (A.symmetric && chosen_->name() != "cholmod")
    if (const SolveStatus status = factor_by_cholesky(A); status != SolveStatus::kIndefinite) return status;
  return factor_by_lu(A);
}

SolveStatus StepSolver::factor_chosen(const BorderedMatrix& A) {
  matrix_ = &A;
  definite_ = false;
  if (!A.symmetric && !chosen_->supports_unsymmetric()) {
    counters::count("integrate.unsymmetric");
    return factor_by_lu(A);
  }
  active_ = chosen_.get();
  const long before = chosen_->counters().factorisations;
  const SolveStatus status = chosen_->factor(A);
  if (status == SolveStatus::kIndefinite) indefinite_ += chosen_->counters().factorisations - before;
  return status;
}

SolveStatus StepSolver::factor_definite(const BorderedMatrix& A) {
  matrix_ = &A;
  active_ = chosen_.get();
  definite_ = true;
  const SolveStatus status = chosen_->factor(A);
  if (status == SolveStatus::kOk) ++projected_;
  return status;
}

SolveStatus StepSolver::factor_balanced() {
  matrix_ = nullptr;
  definite_ = false;
  active_ = chosen_.get();
  return chosen_->factor_balanced();
}

SolveStatus StepSolver::factor_balanced_definite() {
  ++indefinite_;
  const SolveStatus status = factor_balanced();
  definite_ = true;
  if (status == SolveStatus::kOk) ++projected_;
  return status;
}

SolveStatus StepSolver::factor(const BorderedMatrix& A) {
  const SolveStatus status = factor_chosen(A);
  return status == SolveStatus::kIndefinite ? factor_direct(A) : status;
}

SolveStatus StepSolver::solve_symmetric(const VecX& b, VecX& x) {
  SolveStatus status = active_->solve(b, x);
  if (active_ != chosen_.get()) return status;
  if (status == SolveStatus::kNotConverged && matrix_) {
    ++unconverged_;
    status = matrix_->symmetric ? factor_by_cholesky(*matrix_) : factor_by_lu(*matrix_);
    if (status == SolveStatus::kOk) return active_->solve(b, x);
  }
  if (status == SolveStatus::kIndefinite && !definite_) ++indefinite_;
  return status;
}

template <class Columns>
SolveStatus StepSolver::solve_any(const Columns& b, Columns& x) {
  Columns* kept = nullptr;
  if (&b == &x && active_ == chosen_.get()) {
    if constexpr (std::is_same_v<Columns, VecX>)
      kept = &kept_column_;
    else
      kept = &kept_columns_;
    *kept = b;
  }
  const SolveStatus status = active_->solve(b, x);
  if (active_ != chosen_.get()) return status;
  if (!matrix_ || (status != SolveStatus::kIndefinite && status != SolveStatus::kNotConverged)) return status;
  ++(status == SolveStatus::kIndefinite ? indefinite_ : unconverged_);
  if (const SolveStatus direct = factor_direct(*matrix_); direct != SolveStatus::kOk) return direct;
  return active_->solve(kept ? *kept : b, x);
}

template SolveStatus StepSolver::solve_any(const VecX&, VecX&);
template SolveStatus StepSolver::solve_any(const MatX&, MatX&);

const SolverCounters& StepSolver::counters() const {
  sum_ = chosen_->counters();
  for (const auto* behind : {cholesky_.get(), lu_.get()})
    if (behind) sum_ += behind->counters();
  return sum_;
}

void StepSolver::report(dynamics::StepperCounters& counters) const {
  counters.solver = this->counters();
  counters.indefinite = indefinite_;
  counters.projected = projected_;
  counters.unconverged = unconverged_;
}

}  // namespace palpate::integrate
