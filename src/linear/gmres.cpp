#include "linear/gmres.h"

#include <algorithm>
#include <cmath>

#include "linear/make.h"
#include "linear/settings.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/core/finite.h"
#include "palpate/linear/solvers.h"

namespace palpate::linear {

using dynamics::BorderedMatrix;
using dynamics::SolveStatus;

namespace {

/// What the recurrence says of a residual drifts from b - A x by rounding; so often is the iteration begun
/// again from there.
constexpr int kRestarts = 4;
/// Of the preconditioner's own iterations: each direction takes two digits at most, so no more of them are
/// spent than the residual needs.
constexpr double kInnerTolerance = 1e-2;

}  // namespace

Gmres::Gmres(double rtol, std::unique_ptr<dynamics::LinearSolver> inner)
    : rtol_(std::max(rtol, kTightest)), inner_(std::move(inner)) {
  counters::count("integrate.solver.gmres");
}

const dynamics::SolverCounters& Gmres::counters() const {
  sum_ = inner_->counters();
  sum_.solves = solves_;  // of the preconditioner there are many a right-hand side
  sum_.iterations += products_;
  return sum_;
}

SolveStatus Gmres::factor(const BorderedMatrix& A) {
  const bool same = matrix_ == &A && A.values_version != 0 && A.values_version == values_version_;
  matrix_ = &A;
  if (same) return status_;
  values_version_ = A.values_version;
  const auto& values = A.body.values();
  if (!all_finite(Eigen::Map<const VecX>(values.data(), static_cast<Eigen::Index>(values.size()))) ||
      !all_finite(A.right) || !all_finite(A.bottom) || !all_finite(A.corner))
    return status_ = SolveStatus::kSingular;
  return status_ = inner_->factor(part_.of(A));
}

SolveStatus Gmres::solve(const VecX& b, VecX& x) {
  check(b.rows());
  b_ = b;  // a copy: the solution may stand in its place
  const SolveStatus status = solve_column();
  if (status == SolveStatus::kOk) x = x_;
  return status;
}

SolveStatus Gmres::solve(const MatX& B, MatX& X) {
  check(B.rows());
  X.resize(B.rows(), B.cols());
  for (Eigen::Index c = 0; c < B.cols(); ++c) {
    b_ = B.col(c);
    if (const SolveStatus status = solve_column(); status != SolveStatus::kOk) return status;
    X.col(c) = x_;
  }
  return SolveStatus::kOk;
}

void Gmres::check(Eigen::Index rows) const {
  PALPATE_CHECK(status_ == SolveStatus::kOk, "solver gmres: solve without a factor");
  PALPATE_CHECK(matrix_->values_version == values_version_,
                "solver gmres: the matrix changed between factor and solve");
  PALPATE_CHECK(rows == matrix_->size(), "right-hand side has {} rows, the matrix {}", rows, matrix_->size());
}

void Gmres::multiply(const VecX& v, VecX& Av) {
  matrix_->multiply(v, Av);
  ++products_;
}

SolveStatus Gmres::solve_column() {
  ++solves_;
  x_.setZero(b_.size());
  const double goal = rtol_ * b_.norm();
  if (goal == 0.0) return SolveStatus::kOk;
  if (!std::isfinite(goal)) return SolveStatus::kNotConverged;
  r_ = b_;
  for (int i = 0; i <= kRestarts; ++i) {
    if (const SolveStatus status = reduce_residual(goal); status != SolveStatus::kOk) return status;
    multiply(x_, w_);
    r_ = b_ - w_;
    if (r_.norm() <= goal) return SolveStatus::kOk;
  }
  return SolveStatus::kNotConverged;
}

/// x += Z y with y the least |r - A Z y|, Z = S^-1 V, V an orthonormal basis: Arnoldi by modified
/// Gram-Schmidt, the least squares by Givens rotations.
SolveStatus Gmres::reduce_residual(double goal) {
  V_.resize(b_.size(), kDirections + 1);
  Z_.resize(b_.size(), kDirections);
  H_.setZero(kDirections + 1, kDirections);
  g_.setZero(kDirections + 1, 1);
  g_(0, 0) = r_.norm();
  V_.col(0) = r_ / g_(0, 0);
  int k = 0;
  while (k < kDirections && std::abs(g_(k, 0)) > goal) {
    v_ = V_.col(k);
    ++directions_;
    if (const SolveStatus status = inner_->solve(v_, z_); status != SolveStatus::kOk) return status;
    Z_.col(k) = z_;
    multiply(z_, w_);
    for (int i = 0; i <= k; ++i) {
      H_(i, k) = V_.col(i).dot(w_);
      w_ -= H_(i, k) * V_.col(i);
    }
    const double beyond = w_.norm();
    if (!std::isfinite(beyond)) return SolveStatus::kNotConverged;
    for (int i = 0; i < k; ++i) rotation_[static_cast<std::size_t>(i)].rotate(H_, i, k);
    H_(k + 1, k) = beyond;
    Rotation& last = rotation_[static_cast<std::size_t>(k)];
    last.make(H_(k, k), beyond);
    last.rotate(H_, k, k);
    last.rotate(g_, k, 0);
    ++k;
    if (beyond == 0.0) break;  // the solution lies in what was spanned
    V_.col(k) = w_ / beyond;
  }
  if (k == 0) return SolveStatus::kOk;
  y_ = H_.topLeftCorner(k, k).triangularView<Eigen::Upper>().solve(g_.col(0).head(k));
  x_.noalias() += Z_.leftCols(k) * y_;
  return std::abs(g_(k, 0)) > goal && k == kDirections ? SolveStatus::kNotConverged : SolveStatus::kOk;
}

void Gmres::Rotation::make(double a, double b) {
  const double r = std::hypot(a, b);
  c = r == 0.0 ? 1.0 : a / r;
  s = r == 0.0 ? 0.0 : b / r;
}

template <class Columns>
void Gmres::Rotation::rotate(Columns& M, int row, int column) const {
  const double a = M(row, column), b = M(row + 1, column);
  M(row, column) = c * a + s * b;
  M(row + 1, column) = c * b - s * a;
}

std::unique_ptr<dynamics::LinearSolver> make_gmres(const IntegratorSpec& spec) {
  check_linear_rtol("gmres", spec);
  IntegratorSpec inner = spec;
  inner.linear_rtol = kInnerTolerance;
  return std::make_unique<Gmres>(spec.linear_rtol, make_linear_solver("pcg-two-level", inner));
}

}  // namespace palpate::linear
