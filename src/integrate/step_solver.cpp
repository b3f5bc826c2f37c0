#include "integrate/step_solver.h"

#include "integrate/make.h"
#include "palpate/core/counters.h"

namespace palpate::integrate {

using dynamics::BorderedMatrix;
using dynamics::SolverCounters;
using dynamics::SolveStatus;

StepSolver::StepSolver(std::unique_ptr<dynamics::LinearSolver> chosen) : chosen_(std::move(chosen)), active_(chosen_.get()) {}

SolveStatus StepSolver::factor_by_lu(const BorderedMatrix& A) {
  if (!lu_) lu_ = make_umfpack({});
  active_ = lu_.get();
  return lu_->factor(A);
}

SolveStatus StepSolver::factor(const BorderedMatrix& A) {
  if (!A.symmetric && !chosen_->supports_unsymmetric()) {
    counters::count("integrate.unsymmetric");
    return factor_by_lu(A);
  }
  active_ = chosen_.get();
  const long before = chosen_->counters().factorisations;
  const SolveStatus status = chosen_->factor(A);
  if (status != SolveStatus::kIndefinite) return status;
  indefinite_ += chosen_->counters().factorisations - before;
  return factor_by_lu(A);
}

SolverCounters StepSolver::counters() const {
  SolverCounters sum = chosen_->counters();
  if (!lu_) return sum;
  const SolverCounters& lu = lu_->counters();
  sum.symbolic += lu.symbolic;
  sum.factorisations += lu.factorisations;
  sum.solves += lu.solves;
  sum.iterations += lu.iterations;
  sum.symbolic_s += lu.symbolic_s;
  sum.factor_s += lu.factor_s;
  sum.solve_s += lu.solve_s;
  return sum;
}

}  // namespace palpate::integrate
