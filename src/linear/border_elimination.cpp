#include "linear/border_elimination.h"

#include <cmath>

#include "core/finite.h"
#include "palpate/core/error.h"

namespace palpate::linear {

using dynamics::BorderedMatrix;
using dynamics::SolveStatus;

bool BorderElimination::same(const BorderedMatrix& A) const {
  return A.values_version != 0 && A.values_version == values_version_ &&
         A.body.pattern_version() == body_.body.pattern_version() && A.border_size() == border_;
}

SolveStatus BorderElimination::factor(const BorderedMatrix& A) {
  const bool unchanged = same(A);
  values_version_ = A.values_version;
  nodal_ = A.nodal_size();
  border_ = A.border_size();
  if (border_ == 0) return body_solver_->factor(A);
  if (!unchanged) {
    body_.body = A.body;
    body_.right.resize(nodal_, 0);
    body_.bottom.resize(0, nodal_);
    body_.corner.resize(0, 0);
    body_.positions = A.positions;
    body_.symmetric = A.symmetric;
    body_.touch();
  }
  // another user of the body's solver may have factored another matrix since
  if (const SolveStatus status = body_solver_->factor(body_); status != SolveStatus::kOk) {
    values_version_ = 0;
    return border_status_ = status;
  }
  return unchanged ? border_status_ : border_status_ = factor_border(A);
}

SolveStatus BorderElimination::factor_border(const BorderedMatrix& A) {
  if (!all_finite(A.right) || !all_finite(A.bottom) || !all_finite(A.corner)) return SolveStatus::kSingular;
  columns_ += border_;
  if (const SolveStatus status = body_solver_->solve(A.right, W_); status != SolveStatus::kOk) return status;
  bottom_ = A.bottom;
  S_ = A.corner;
  S_.noalias() -= bottom_ * W_;
  lu_.compute(S_);
  const double smallest = lu_.matrixLU().diagonal().cwiseAbs().minCoeff();
  return smallest > 0.0 && std::isfinite(smallest) ? SolveStatus::kOk : SolveStatus::kSingular;
}

SolveStatus BorderElimination::solve(const VecX& b, VecX& x) {
  if (border_ == 0) return body_solver_->solve(b, x);
  PALPATE_CHECK(border_status_ == SolveStatus::kOk, "border elimination: solve() called before factor()");
  PALPATE_CHECK(b.size() == nodal_ + border_, "right-hand side has {} rows, the matrix {}", b.size(),
                nodal_ + border_);
  z_ = b.head(nodal_);
  c_ = b.tail(border_);
  if (const SolveStatus status = body_solver_->solve(z_, z_); status != SolveStatus::kOk) return status;
  c_.noalias() -= bottom_ * z_;
  y_ = lu_.solve(c_);
  x.resize(nodal_ + border_);
  x.head(nodal_) = z_;
  x.head(nodal_).noalias() -= W_ * y_;
  x.tail(border_) = y_;
  return SolveStatus::kOk;
}

SolveStatus BorderElimination::solve(const MatX& B, MatX& X) {
  X.resize(B.rows(), B.cols());
  for (Eigen::Index c = 0; c < B.cols(); ++c) {
    column_ = B.col(c);
    if (const SolveStatus status = solve(column_, column_); status != SolveStatus::kOk) return status;
    X.col(c) = column_;
  }
  return SolveStatus::kOk;
}

const dynamics::SolverCounters& BorderElimination::counters() const {
  counters_ = body_solver_->counters();
  counters_.solves -= columns_;
  return counters_;
}

}  // namespace palpate::linear
