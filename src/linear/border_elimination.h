#pragma once
#include <Eigen/LU>
#include <cstdint>
#include <memory>

#include "palpate/dynamics/linear_solver.h"

namespace palpate::linear {

/// Solves bordered matrices by a solver of the body; the border is eliminated by its Schur complement:
///     [B R] [x]   [b]      W = B^-1 R,  S = C - L W  (per matrix: one body solve per border column)
///     [L C] [y] = [c]      z = B^-1 b,  y = S^-1 (c - L z),  x = z - W y  (per right-hand side: one)
/// L = R^T is not required. The rows of a rigid tool are not the transpose of its columns (rotations do not
/// commute, and dampers turn with the tool: contact/tangent.cpp), but without friction the nodes' block B is
/// symmetric and keeps its Cholesky factor; only S, 6 to 13 rows, is factored by LU. A relative error e of
/// B^-1 leaves an error e |L| |W| in S. Relative to S this is e times the ratio of the nodes' compliance term
/// L W to the remainder C - L W, which is of the order of the contact stiffness over the stiffness of the
/// nodes behind it: tens.
///
/// factor() and solve() return the body solver's status; kSingular also means that S has no inverse. Without
/// a border the body's solver gets A itself.
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
  /// Whether A is the matrix last factored, by versions.
  bool same(const dynamics::BorderedMatrix& A) const;
  /// Computes W = B^-1 R and the LU factor of S.
  dynamics::SolveStatus factor_border(const dynamics::BorderedMatrix& A);

  std::unique_ptr<dynamics::LinearSolver> body_solver_;
  dynamics::BorderedMatrix body_;  ///< copy of A without its border
  std::uint64_t values_version_ = 0;
  Eigen::Index nodal_ = 0, border_ = 0;
  dynamics::SolveStatus border_status_ = dynamics::SolveStatus::kSingular;
  MatX bottom_, W_, S_;
  Eigen::PartialPivLU<MatX> lu_;  ///< LU factor of S
  VecX z_, c_, y_, column_;
  long columns_ = 0;  ///< columns of W solved so far, excluded from counters().solves
  mutable dynamics::SolverCounters counters_;
};

}  // namespace palpate::linear
