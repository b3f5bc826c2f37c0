#pragma once
#include <optional>

#include "dynamics/mixed_precision_step.h"
#include "linear/mixed_precision/lagged_matrix_policy.h"
#include "linear/mixed_precision/solve_state.h"

namespace palpate::linear {

/// Iterative refinement with a lagged matrix, the matrix of an earlier step. With Ao for the copy and A for
/// the matrix of the equations, A x = b is Ao x = b - A x + Ao x: with an approximation x on the right this
/// is a system with the copy for a better approximation, whose error is A^-1 (Ao - A) times the correction
/// (lagged_matrix_policy.h). Ao x needs no product: it is the right-hand side minus the residual at the
/// end of the iteration.
///
/// The same scheme serves a copy of the step's matrix whose rounding is too coarse for a solution but not for
/// a correction; then the residual is checked after every correction.
class Refinement {
 public:
  explicit Refinement(SolveState& state) : s_(state), lag_(state.rtol) {}

  /// Allocates memory for the copy's order.
  void prepare();
  /// The copy is now a new matrix.
  /// @param rounded  Whether its rounding is too coarse for a direct solution, so that solve() must be used.
  /// @param bordered  Whether it lacks the unsymmetric part of a border, so that solve() must be used.
  void renew(bool rounded = false, bool bordered = false) {
    lag_.renew(bordered);
    rounded_ = rounded;
    own_ = rounded || bordered;
  }
  /// The copy has new points. @param rounded  as for renew()
  void renew_points(bool rounded) { rounded_ = rounded; }
  /// The copy's equations were solved; `correction` is the relative part that the initial guess missed.
  void solved(double correction) { lag_.solved(correction); }
  /// Whether there is an initial guess for refinement with a rounded copy.
  bool can_correct() const { return s_.guess.count() > 0 && !s_.iteration.first(); }
  /// Sets an absolute energy-norm error that is accepted whatever the relative tolerance.
  void allow_error(double error) { allowed_ = error; }
  /// Solves A x = b for equations whose matrix is close to the copy, with which a solution was found before,
  /// or for the equations of a rounded copy. Adds all time except the residual's to solve_s. Result as for
  /// MixedPrecisionSolver::solve_by_refinement.
  std::optional<dynamics::SolveStatus> solve(dynamics::ResidualFunction& equations, VecX& x);

 private:
  /// Iterates corrections until the error is within the tolerance.
  dynamics::SolveStatus approach(dynamics::ResidualFunction& equations, int most_residuals, VecX& x);
  /// Returns the admissible error relative to a solution of this squared energy norm.
  double tolerance(double solution) const;
  /// Evaluates residual_ = b - A x.
  void evaluate_residual(dynamics::ResidualFunction& equations, VecX& x);
  /// Sets the right-hand side of the copy's system, b = residual_ + Ao x.
  ProjectedGuess::Start begin_with_residual();
  /// Solves for a correction with the copy.
  template <class Set>
  dynamics::SolveStatus descend(double start, double rtol, double absolute, double& open, Set&& set_residual);
  /// Measures and corrects the error due to the lagged matrix.
  dynamics::SolveStatus correct_lag(double solution, double& stale, double& open);

  SolveState& s_;
  LaggedMatrixPolicy lag_;
  double allowed_ = 0.0;
  bool rounded_ = false, own_ = false;  ///< own_: the next equations are those of the copy
  VecX residual_;                       ///< last residual, in the equations' order
  Singles open_;                        ///< residual at the end of the previous iteration
  /// Time spent in residual evaluations [s].
  double residuals_s_ = 0.0;
};

}  // namespace palpate::linear
