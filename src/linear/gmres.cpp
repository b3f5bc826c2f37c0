#include "linear/gmres.h"

#include <algorithm>
#include <cmath>

#include "core/clock.h"
#include "core/counters.h"
#include "core/finite.h"
#include "linear/make.h"
#include "linear/settings.h"
#include "palpate/core/error.h"
#include "palpate/linear/solvers.h"

namespace palpate::linear {

using dynamics::BorderedMatrix;
using dynamics::SolveStatus;

namespace {

/// Restarts from a recomputed residual b - A x, where the residual of the recurrence has drifted from it.
constexpr int kRestarts = 4;
/// With an exact S the recurrence drifts by some roundings times the root of S's condition, 1e-11 at 1e10:
/// b - A x is computed where the tolerance is below this.
constexpr double kCheckedBelow = 1e-10;
/// Tolerance of the iteration that solves with S: a direction gains two digits at most, so no more of them
/// are worth their cost.
constexpr double kInnerTolerance = 1e-2;

}  // namespace

Gmres::Gmres(double rtol, dynamics::LinearSolver& symmetric)
    : rtol_(std::max(rtol, kTightest)), symmetric_(symmetric) {
  counters::count("integrate.solver.gmres");
}

Gmres::Gmres(double rtol, std::unique_ptr<dynamics::LinearSolver> symmetric)
    : rtol_(std::max(rtol, kTightest)), owned_(std::move(symmetric)), symmetric_(*owned_) {
  counters::count("integrate.solver.gmres");
}

const dynamics::SolverCounters& Gmres::counters() const {
  sum_ = counters_;
  if (owned_) sum_ += owned_->counters();
  return sum_;
}

SolveStatus Gmres::factor(const BorderedMatrix& A) {
  matrix_ = &A;
  values_version_ = A.values_version;
  const auto& values = A.body.values();
  if (!all_finite(Eigen::Map<const VecX>(values.data(), static_cast<Eigen::Index>(values.size()))) ||
      !all_finite(A.right) || !all_finite(A.bottom) || !all_finite(A.corner))
    return status_ = SolveStatus::kSingular;
  return status_ = symmetric_.factor(part_.of(A));
}

SolveStatus Gmres::solve(const VecX& b, VecX& x) {
  check(b.rows());
  b_ = b;  // copied: b and x may be one vector
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
  PALPATE_CHECK(status_ == SolveStatus::kOk, "solver gmres: solve() called before factor()");
  PALPATE_CHECK(matrix_->values_version == values_version_,
                "solver gmres: the matrix changed between factor and solve");
  PALPATE_CHECK(rows == matrix_->size(), "right-hand side has {} rows, the matrix {}", rows, matrix_->size());
}

void Gmres::multiply(const VecX& v, VecX& Av) {
  const ScopedTimer timer(counters_.solve_s);
  matrix_->multiply(v, Av);
  ++counters_.iterations;
}

SolveStatus Gmres::precondition(const VecX& r, VecX& z) {
  --counters_.solves;  // symmetric_ counts it, and it is no right-hand side
  return symmetric_.solve(r, z);
}

SolveStatus Gmres::solve_column() {
  if (!owned_ && part_.whole()) return symmetric_.solve(b_, x_);
  ++counters_.solves;
  x_.setZero(b_.size());
  if (b_.isZero(0.0)) return SolveStatus::kOk;
  r_ = b_;
  if (const SolveStatus status = precondition(r_, z_); status != SolveStatus::kOk) return status;
  double size = std::sqrt(r_.dot(z_));
  const double goal = rtol_ * size;
  if (!std::isfinite(goal)) return SolveStatus::kNotConverged;
  for (int i = 0; i <= kRestarts; ++i) {
    if (const SolveStatus status = reduce_residual(size, goal); status != SolveStatus::kOk) return status;
    if (!owned_ && rtol_ >= kCheckedBelow) return SolveStatus::kOk;
    multiply(x_, r_);
    r_ = b_ - r_;
    if (const SolveStatus status = precondition(r_, z_); status != SolveStatus::kOk) return status;
    size = std::sqrt(std::max(0.0, r_.dot(z_)));
    if (size <= goal) return SolveStatus::kOk;
  }
  return SolveStatus::kNotConverged;
}

/// Keeps r_/size and z_/size as basis vector k and its direction.
void Gmres::keep_direction(std::size_t k, double size) {
  if (k == V_.size()) {
    V_.emplace_back();
    Z_.emplace_back();
  }
  V_[k] = r_ / size;
  Z_[k] = z_ / size;
}

/// Adds to x the Z y of least |r - A Z y|, from r_ and z_ = S^-1 r_ with |r_| = size.  A Z_k = V_{k+1} H_k by
/// Arnoldi's modified Gram-Schmidt in the inner product of S^-1; the least squares by Givens rotations.
SolveStatus Gmres::reduce_residual(double size, double goal) {
  H_.setZero(kDirections + 1, kDirections);
  g_.setZero(kDirections + 1, 1);
  g_(0, 0) = size;
  keep_direction(0, size);
  int k = 0;
  while (std::abs(g_(k, 0)) > goal) {
    if (k == kDirections) return SolveStatus::kNotConverged;
    const auto at = static_cast<std::size_t>(k);
    ++directions_;
    multiply(Z_[at], r_);
    for (std::size_t i = 0; i <= at; ++i) {
      const double along = Z_[i].dot(r_);
      H_(static_cast<Eigen::Index>(i), k) = along;
      r_ -= along * V_[i];
    }
    if (const SolveStatus status = precondition(r_, z_); status != SolveStatus::kOk) return status;
    const double beyond = std::sqrt(std::max(0.0, r_.dot(z_)));
    if (!std::isfinite(beyond)) return SolveStatus::kNotConverged;
    for (int i = 0; i < k; ++i) rotation_[static_cast<std::size_t>(i)].rotate(H_, i, k);
    H_(k + 1, k) = beyond;
    Rotation& last = rotation_[at];
    last.make(H_(k, k), beyond);
    last.rotate(H_, k, k);
    last.rotate(g_, k, 0);
    ++k;
    if (beyond == 0.0) break;  // the basis spans the solution
    if (k < kDirections) keep_direction(at + 1, beyond);
  }
  y_ = H_.topLeftCorner(k, k).triangularView<Eigen::Upper>().solve(g_.col(0).head(k));
  for (int i = 0; i < k; ++i) x_ += y_[i] * Z_[static_cast<std::size_t>(i)];
  return SolveStatus::kOk;
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
