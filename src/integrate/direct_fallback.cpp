#include "integrate/direct_fallback.h"

#include <utility>

#include "core/counters.h"
#include "palpate/linear/solvers.h"

namespace palpate::integrate {

using dynamics::BorderedMatrix;
using dynamics::SolveStatus;

DirectFallback::DirectFallback(std::unique_ptr<dynamics::LinearSolver> chosen, const IntegratorSpec& spec)
    : spec_(spec), chosen_(std::move(chosen)), active_(chosen_.get()) {}

SolveStatus DirectFallback::factor(const BorderedMatrix& A) {
  if (!A.symmetric && !chosen_->supports_unsymmetric()) {
    if (!unsymmetric_) unsymmetric_ = linear::make_unsymmetric_solver(*chosen_, spec_);
    active_ = unsymmetric_.get();
  } else {
    active_ = chosen_.get();
  }
  return active_->factor(A);
}

SolveStatus DirectFallback::factor_by_lu(const BorderedMatrix& A) {
  if (!lu_) lu_ = linear::make_linear_solver("umfpack");
  active_ = lu_.get();
  counters::count("integrate.matrices_left_to_lu");
  ++left_to_lu_;
  return lu_->factor(A);
}

SolveStatus DirectFallback::factor_by_cholesky(const BorderedMatrix& A) {
  if (!cholesky_) cholesky_ = linear::make_linear_solver("cholmod");
  active_ = cholesky_.get();
  return cholesky_->factor(A);
}

SolveStatus DirectFallback::factor_direct(const BorderedMatrix& A) {
  if (A.symmetric && chosen_->name() != "cholmod")
    if (const SolveStatus status = factor_by_cholesky(A); status != SolveStatus::kIndefinite) return status;
  return factor_by_lu(A);
}

const dynamics::SolverCounters& DirectFallback::counters() const {
  sum_ = chosen_->counters();
  for (const auto* behind : {unsymmetric_.get(), cholesky_.get(), lu_.get()})
    if (behind) sum_ += behind->counters();
  return sum_;
}

}  // namespace palpate::integrate
