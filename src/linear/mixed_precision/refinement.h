#pragma once
#include <optional>

#include "linear/mixed_precision/lagged_matrix_policy.h"
#include "linear/mixed_precision/solve_state.h"
#include "palpate/dynamics/mixed_precision_step.h"

namespace palpate::linear {

/// Iterative refinement with a lagged matrix, that of an earlier step.  With Ao for the copy and A for the
/// matrix of the equations, A x = b is Ao x = b - A x + Ao x: where x on the right is an approximation, this
/// is a system with the copy for a better one, whose error is A^-1 (Ao - A) times the correction
/// (lagged_matrix_policy.h).  Ao x needs no product: it is the right-hand side less the residual that the
/// iteration ended with.
///
/// In the same way it solves by a copy of the step's own matrix whose rounding is too coarse for a solution,
/// but not for a correction; then the residual is checked after every correction.
class Refinement {
 public:
  explicit Refinement(SolveState& state) : s_(state), lag_(state.rtol) {}

  /// Memory for the copy's order.
  void prepare();
  /// The copy is of a new matrix.  @param rounded  too coarsely for a solution: solve() is what solves with
  /// it
  void renew(bool rounded = false) {
    lag_.renew();
    rounded_ = own_ = rounded;
  }
  /// The copy's own equations were solved, up to this correction of the initial guess.
  void solved(double correction) { lag_.solved(correction); }
  /// Whether there is an initial guess that solves with a rounded copy can begin with.
  bool can_correct() const { return s_.guess.count() > 0 && !s_.iteration.first(); }
  /// x = A^-1 b for equations whose matrix is close to the copy, with which a solution was found before; or
  /// for those of a rounded copy.  Counts in solve_s all time but the residual's.  As
  /// MixedPrecisionSolver::solve_by_refinement.
  std::optional<dynamics::SolveStatus> solve(dynamics::ResidualFunction& equations, VecX& x);

 private:
  dynamics::SolveStatus approach(dynamics::ResidualFunction& equations, VecX& x);
  void evaluate_residual(dynamics::ResidualFunction& equations, VecX& x);
  ProjectedGuess::Start begin_with_residual();
  template <class Set>
  dynamics::SolveStatus descend(double start, double rtol, double& open, Set&& set_residual);
  dynamics::SolveStatus correct_lag(double solution, double& stale, double& open);

  SolveState& s_;
  LaggedMatrixPolicy lag_;
  bool rounded_ = false, own_ = false;  ///< own_: the next equations are the copy's own
  VecX residual_;                       ///< the last one, in the equations' order
  Singles open_;                        ///< residual that an iteration before the last one ended with
  double residuals_s_ = 0.0;
};

}  // namespace palpate::linear
