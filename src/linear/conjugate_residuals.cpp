#include "linear/conjugate_residuals.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linear/settings.h"
#include "palpate/core/clock.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/core/finite.h"

namespace palpate::linear {

using dynamics::BorderedMatrix;
using dynamics::SolveStatus;

namespace {

/// The recurrences of r and S^-1 r drift by some roundings times the root of S's condition, 1e-11 at 1e10.
/// From this tolerance on the end is checked with b - A x itself.
constexpr double kCheckedBelow = 1e-10;

}  // namespace

ConjugateResiduals::ConjugateResiduals(double rtol, dynamics::LinearSolver& symmetric)
    : rtol_(std::max(rtol, kTightest)), symmetric_(symmetric) {
  counters::count("integrate.solver.conjugate_residuals");
}

SolveStatus ConjugateResiduals::factor(const BorderedMatrix& A) {
  matrix_ = &A;
  const auto& values = A.body.values();
  if (!all_finite(Eigen::Map<const VecX>(values.data(), static_cast<Eigen::Index>(values.size()))) ||
      !all_finite(A.right) || !all_finite(A.bottom) || !all_finite(A.corner))
    return status_ = SolveStatus::kSingular;
  return status_ = symmetric_.factor(part_.of(A));
}

SolveStatus ConjugateResiduals::solve(const VecX& b, VecX& x) {
  b_ = b;  // a copy: the solution may stand in its place
  const SolveStatus status = solve_column();
  if (status == SolveStatus::kOk) x = x_;
  return status;
}

SolveStatus ConjugateResiduals::solve(const MatX& B, MatX& X) {
  X.resize(B.rows(), B.cols());
  for (Eigen::Index c = 0; c < B.cols(); ++c) {
    b_ = B.col(c);
    if (const SolveStatus status = solve_column(); status != SolveStatus::kOk) return status;
    X.col(c) = x_;
  }
  return SolveStatus::kOk;
}

SolveStatus ConjugateResiduals::precondition(const VecX& r, VecX& z) {
  --counters_.solves;
  return symmetric_.solve(r, z);
}

void ConjugateResiduals::multiply(const VecX& v, VecX& Av) {
  const ScopedTimer timer(counters_.solve_s);
  matrix_->multiply(v, Av);
  ++counters_.iterations;
}

SolveStatus ConjugateResiduals::solve_column() {
  PALPATE_CHECK(status_ == SolveStatus::kOk, "conjugate residuals: solve without a factor");
  PALPATE_CHECK(b_.size() == matrix_->size(), "right-hand side has {} rows, the matrix {}", b_.size(),
                matrix_->size());
  if (part_.whole()) return symmetric_.solve(b_, x_);
  ++counters_.solves;
  x_.setZero(b_.size());
  r_ = b_;
  if (const SolveStatus status = precondition(r_, z_); status != SolveStatus::kOk) return status;
  const double goal = rtol_ * std::sqrt(r_.dot(z_));
  if (goal == 0.0) return SolveStatus::kOk;
  if (!std::isfinite(goal)) return SolveStatus::kNotConverged;
  for (int left = kLimit; left > 0;) {
    if (const SolveStatus status = reduce_residual(goal, left); status != SolveStatus::kOk) return status;
    if (rtol_ >= kCheckedBelow) return SolveStatus::kOk;
    multiply(x_, next_.q);
    r_ = b_ - next_.q;
    if (const SolveStatus status = precondition(r_, z_); status != SolveStatus::kOk) return status;
    if (r_.dot(z_) <= goal * goal) return SolveStatus::kOk;
  }
  return SolveStatus::kNotConverged;
}

/// From x, r = b - A x and z = S^-1 r on, until r as the recurrence has it is below the goal.
SolveStatus ConjugateResiduals::reduce_residual(double goal, int& left) {
  for (bool first = true; r_.dot(z_) > goal * goal; first = false) {
    if (left-- == 0) return SolveStatus::kNotConverged;
    next_.p = z_;
    multiply(next_.p, next_.q);
    if (const SolveStatus status = precondition(next_.q, next_.t); status != SolveStatus::kOk) return status;
    if (!first) {
      const double along = last_.t.dot(next_.q);
      next_.p -= along * last_.p;
      next_.q -= along * last_.q;
      next_.t -= along * last_.t;
    }
    const double size = std::sqrt(next_.q.dot(next_.t));
    if (!std::isfinite(size) || size == 0.0) return SolveStatus::kNotConverged;
    for (VecX* v : {&next_.p, &next_.q, &next_.t}) *v /= size;
    const double step = next_.t.dot(r_);
    x_ += step * next_.p;
    r_ -= step * next_.q;
    z_ -= step * next_.t;
    std::swap(last_, next_);
  }
  return SolveStatus::kOk;
}

}  // namespace palpate::linear
