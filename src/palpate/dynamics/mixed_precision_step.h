#pragma once
#include <optional>

#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::dynamics {

/// A system of equations that is known by the residuals of its approximate solutions.
class ResidualFunction {
 public:
  virtual ~ResidualFunction() = default;
  /// r = b - A x; zero along held directions.
  virtual void at(const VecX& x, VecX& r) = 0;
};

/// What a mixed-precision step matrix serves for.
enum class StepMatrixUse {
  kSolve,       ///< LinearSolver::solve() takes right-hand sides, which are zero along held directions
  kRefine,      ///< its rounding is too coarse for that, not for corrections: solve_by_refinement() serves
  kIndefinite,  ///< for nothing: it is indefinite
  kNone,        ///< for nothing: it is singular, not finite or too coarse
};

/// Optional capability of a LinearSolver: it solves with step matrices of mixed precision that are written
/// straight into its own order, and keeps one as a lagged matrix for the steps that follow.  A class derives
/// from it beside LinearSolver.
class MixedPrecisionSolver {
 public:
  virtual ~MixedPrecisionSolver() = default;
  /// Room for a matrix of this pattern in the solver's own order, to be written and then prepared by
  /// factor_step_matrix(); null where matrices of this pattern are better given to factor(), in double.  The
  /// pattern stays where it is until the next call.
  virtual ZeroRowSumMatrix* step_matrix(const BlockSparse& pattern) = 0;
  /// LinearSolver::factor() of what was written there.
  virtual StepMatrixUse factor_step_matrix() = 0;
  /// Solves A x = b by iterative refinement with the step matrix last factored, whether that is A itself,
  /// rounded, or the matrix of an earlier step (a lagged matrix); as accurately as a solve with A.
  /// Empty: there is no such matrix, or it is known to be too far from A; nothing was evaluated.  A status
  /// other than kOk: refinement was tried and did not reach the tolerance.
  virtual std::optional<SolveStatus> solve_by_refinement(ResidualFunction& residual, VecX& x) = 0;
};

/// Optional capability of a MixedPrecisionSolver: the solves of one step that repeats them
/// (RepeatedStepTerm). Their matrices differ in what stands beside the pattern alone, and each solution is
/// close to the one before.  A class derives from it beside MixedPrecisionSolver.
class StepSolves {
 public:
  virtual ~StepSolves() = default;
  struct Solved {
    SolveStatus status;
    bool accurate;  ///< within the tolerance of LinearSolver::solve()
  };
  /// The first one, after factor_step_matrix() has returned StepMatrixUse::kSolve; from where solve() begins.
  /// It ends where the error is within the tolerance, or `share` of the way that the solution has come.
  virtual Solved solve_first(const VecX& b, VecX& x, double share) = 0;
  /// The next one, from the last solution on; ZeroRowSumMatrix::points may have been written anew.  Nothing
  /// is solved, and the status is not kOk, where these are beyond what the matrix serves for.
  virtual Solved solve_next(const VecX& b, VecX& x, double share) = 0;
  /// The last one was the step's: later steps begin with it.  @param x  it
  virtual void end_solves(VecX& x) = 0;
};

}  // namespace palpate::dynamics
