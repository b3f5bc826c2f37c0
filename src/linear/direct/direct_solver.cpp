#include "linear/direct/direct_solver.h"

#include "core/clock.h"
#include "core/counters.h"
#include "core/finite.h"
#include "linear/direct/blas_memory.h"
#include "palpate/core/error.h"

namespace palpate::linear {

using dynamics::BorderedMatrix;
using dynamics::SolveStatus;

DirectSolver::DirectSolver(std::string name, bool unsymmetric, std::unique_ptr<BodyFactor> body)
    : name_(std::move(name)), unsymmetric_(unsymmetric), body_(std::move(body)) {
  counters::count("integrate.solver." + name_);
  reserve_blas_memory();
}

bool DirectSolver::same_pattern(const BorderedMatrix& A) const {
  return A.body.pattern_version() == pattern_version_ && A.nodal_size() == nodal_ &&
         A.border_size() == border_;
}

SolveStatus DirectSolver::factor(const BorderedMatrix& A) {
  PALPATE_CHECK(A.symmetric || unsymmetric_, "solver {} was given an unsymmetric matrix", name_);
  const bool same = same_pattern(A);
  if (same && A.values_version != 0 && A.values_version == values_version_) return status_;
  if (!same && A.nodal_size() > 0 &&
      (A.body.pattern_version() != pattern_version_ || A.nodal_size() != nodal_)) {
    const ScopedTimer timer(counters_.symbolic_s);
    body_->analyse(A.body);
    ++counters_.symbolic;
    counters_.ordering = body_->ordering();
    counters_.orderings = body_->orderings();
  }
  pattern_version_ = A.body.pattern_version();
  values_version_ = A.values_version;
  nodal_ = A.nodal_size();
  border_ = A.border_size();
  const ScopedTimer timer(counters_.factor_s);
  ++counters_.factorisations;
  return status_ = factor_values(A);
}

SolveStatus DirectSolver::factor_values(const BorderedMatrix& A) {
  const auto& values = A.body.values();
  const Eigen::Map<const VecX> body(values.data(), static_cast<Eigen::Index>(values.size()));
  if (!all_finite(body) || !all_finite(A.right) || !all_finite(A.bottom) || !all_finite(A.corner))
    return SolveStatus::kSingular;
  if (nodal_ > 0)
    if (const SolveStatus status = body_->factor(A.body); status != SolveStatus::kOk) return status;
  return border_ > 0 ? factor_border(A) : SolveStatus::kOk;
}

SolveStatus DirectSolver::factor_border(const BorderedMatrix& A) {
  S_ = A.corner;
  if (nodal_ > 0) {
    body_->solve(ConstColumns(A.right.data(), nodal_, border_, Eigen::OuterStride<>(nodal_)), W_);
    bottom_ = A.bottom;
    S_.noalias() -= bottom_ * W_;
  }
  if (!unsymmetric_) {  // A is positive definite exactly when its body and this complement are
    llt_.compute(S_);
    return llt_.info() == Eigen::Success ? SolveStatus::kOk : SolveStatus::kIndefinite;
  }
  lu_.compute(S_);
  const double smallest = lu_.matrixLU().diagonal().cwiseAbs().minCoeff();
  return smallest > 0.0 && std::isfinite(smallest) ? SolveStatus::kOk : SolveStatus::kSingular;
}

void DirectSolver::solve_border(MatX& Y) const {
  if (unsymmetric_)
    Y = lu_.solve(Y);
  else
    llt_.solveInPlace(Y);
}

void DirectSolver::solve_columns(const double* b, double* x, Eigen::Index count) {
  PALPATE_CHECK(status_ == SolveStatus::kOk, "solver {}: solve() called before factor()", name_);
  const ScopedTimer timer(counters_.solve_s);
  counters_.solves += count;
  const Eigen::OuterStride<> stride(nodal_ + border_);
  if (nodal_ > 0) body_->solve(ConstColumns(b, nodal_, count, stride), z_);
  if (border_ > 0) {
    y_ = ConstColumns(b + nodal_, border_, count, stride);
    if (nodal_ > 0) y_.noalias() -= bottom_ * z_;
    solve_border(y_);
    if (nodal_ > 0) z_.noalias() -= W_ * y_;
    Eigen::Map<MatX, 0, Eigen::OuterStride<>>(x + nodal_, border_, count, stride) = y_;
  }
  if (nodal_ > 0) Eigen::Map<MatX, 0, Eigen::OuterStride<>>(x, nodal_, count, stride) = z_;
}

SolveStatus DirectSolver::solve(const MatX& B, MatX& X) {
  PALPATE_CHECK(B.rows() == nodal_ + border_, "right-hand side has {} rows, the matrix {}", B.rows(),
                nodal_ + border_);
  X.resize(B.rows(), B.cols());
  solve_columns(B.data(), X.data(), B.cols());
  return SolveStatus::kOk;
}

SolveStatus DirectSolver::solve(const VecX& b, VecX& x) {
  PALPATE_CHECK(b.size() == nodal_ + border_, "right-hand side has {} rows, the matrix {}", b.size(),
                nodal_ + border_);
  x.resize(b.size());
  solve_columns(b.data(), x.data(), 1);
  return SolveStatus::kOk;
}

}  // namespace palpate::linear
