#pragma once
#include <optional>

#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::dynamics {

/// System of linear equations A x = b that is given by the residuals of its approximate solutions.
class ResidualFunction {
 public:
  virtual ~ResidualFunction() = default;
  /// Computes r = b - A x; zero along held directions.
  virtual void at(const VecX& x, VecX& r) = 0;
};

/// Possible uses of a mixed-precision step matrix.
enum class StepMatrixUse {
  kSolve,   ///< LinearSolver::solve() accepts right-hand sides that are zero along held directions.
  kRefine,  ///< Its rounding is too coarse for solve(), but not for corrections: use solve_by_refinement().
  kIndefinite,  ///< Not usable: it is indefinite.
  kNone,        ///< Not usable: it is singular, not finite or too coarse.
};

/// Optional capability of a LinearSolver: solves with mixed-precision step matrices that are written directly
/// in its node order, and keeps one as a lagged matrix for the following steps. A class inherits it in
/// addition to LinearSolver.
class MixedPrecisionSolver {
 public:
  virtual ~MixedPrecisionSolver() = default;
  /// Returns storage for a matrix of this pattern in the solver's order, to be written and then prepared by
  /// factor_step_matrix(). Null where matrices of this pattern are better passed to factor(), in double. The
  /// pattern must stay at its address until the next call.
  virtual ZeroRowSumMatrix* step_matrix(const BlockSparse& pattern) = 0;
  /// Does the work of LinearSolver::factor() for the matrix written there.
  virtual StepMatrixUse factor_step_matrix() = 0;
  /// Returns the matrix last factored, of which `points` and `border` may be rewritten; null where there is
  /// none.
  virtual ZeroRowSumMatrix* lagged_matrix() = 0;
  /// Takes the points and the border rewritten in lagged_matrix().
  virtual void renew_points() = 0;
  /// Solves A x = b by iterative refinement with the step matrix last factored, which may be A itself,
  /// rounded, or the matrix of an earlier step (a lagged matrix). The result is as accurate as a solve with
  /// A.
  /// Returns empty where there is no such matrix, or it is known to be too far from A; nothing was then
  /// evaluated. A status other than kOk means that refinement was tried and did not reach the tolerance.
  virtual std::optional<SolveStatus> solve_by_refinement(ResidualFunction& residual, VecX& x) = 0;
};

/// Optional capability of a MixedPrecisionSolver: the repeated solves of one step (RepeatedStepTerm). Their
/// matrices differ only in the part outside the sparsity pattern, and each solution is close to the previous
/// one. A class inherits it in addition to MixedPrecisionSolver.
class StepSolves {
 public:
  virtual ~StepSolves() = default;
  /// Result of one of these solves.
  struct Solved {
    SolveStatus status;
    bool accurate;  ///< Error within the tolerance of LinearSolver::solve().
  };
  /// Solves for the first time in a step, after factor_step_matrix() returned StepMatrixUse::kSolve, from the
  /// same initial guess as solve(). Stops where the error is within the tolerance, or below `share` times the
  /// distance from the initial guess.
  virtual Solved solve_first(const VecX& b, VecX& x, double share) = 0;
  /// Solves again, starting from the last solution; ZeroRowSumMatrix::points may have been rewritten. Where
  /// these exceed the precision of the matrix nothing is solved, and the status is not kOk.
  virtual Solved solve_next(const VecX& b, VecX& x, double share) = 0;
  /// Accepts the last solution as the one of the step: later steps start from it.
  /// @param x  the last solution
  virtual void end_solves(VecX& x) = 0;
};

}  // namespace palpate::dynamics
