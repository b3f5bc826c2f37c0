#pragma once
#include <Eigen/LU>
#include <cstdint>
#include <memory>

#include "palpate/dynamics/linear_solver.h"

namespace palpate::linear {

/// A bordered matrix by a solver of its body, the border by its Schur complement:
///     [B R] [x]   [b]      W = B^-1 R,  S = C - L W  (once a matrix: a solution a column of the border)
///     [L C] [y] = [c]      z = B^-1 b,  y = S^-1 (c - L z),  x = z - W y  (once a right-hand side: one)
/// Nothing here asks for L = R^T.  The rows of a rigid tool are no transpose of its columns (rotations do not
/// commute, and dampers turn with it: contact/tangent.cpp), but without friction the nodes' block B is
/// symmetric: it keeps its Cholesky factor, and an LU factor is made of S alone, 6 to 13 rows.  B^-1 of
/// relative error e leaves S an error of e |L| |W|, which is e times what the nodes give way, over what S
/// keeps of C: as stiff contact over the nodes behind it, tens.
///
/// What the body's solver says of B is said of A; kSingular: S has no inverse.  Without a border the body's
/// solver has A itself.
class BorderElimination final : public dynamics::LinearSolver {
 public:
  explicit BorderElimination(std::unique_ptr<dynamics::LinearSolver> body) : body_solver_(std::move(body)) {}
  std::string name() const override { return body_solver_->name(); }
  bool supports_unsymmetric() const override { return body_solver_->supports_unsymmetric(); }
  bool supports_indefinite() const override { return body_solver_->supports_indefinite(); }
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A) override;
  dynamics::SolveStatus solve(const VecX& b, VecX& x) override;
  dynamics::SolveStatus solve(const MatX& B, MatX& X) override;
  const dynamics::SolverCounters& counters() const override;

 private:
  bool same(const dynamics::BorderedMatrix& A) const;
  dynamics::SolveStatus factor_border(const dynamics::BorderedMatrix& A);

  std::unique_ptr<dynamics::LinearSolver> body_solver_;
  dynamics::BorderedMatrix body_;  ///< A without its border
  std::uint64_t values_version_ = 0;
  Eigen::Index nodal_ = 0, border_ = 0;
  dynamics::SolveStatus border_status_ = dynamics::SolveStatus::kSingular;
  MatX bottom_, W_, S_;
  Eigen::PartialPivLU<MatX> lu_;  ///< of S
  VecX z_, c_, y_, column_;
  long columns_ = 0;  ///< of W, which are no right-hand sides
  mutable dynamics::SolverCounters counters_;
};

}  // namespace palpate::linear
