#pragma once
#include <vector>

#include "linear/mixed_precision/solve_state.h"

namespace palpate::linear {

/// Solves with the matrix in a SingleMatrix: conjugate gradients in single precision, corrected by residuals
/// in double (single_pcg.cpp).
class SingleSolve {
 public:
  explicit SingleSolve(SolveState& state) : s_(state) {}

  /// Allocates memory for the copy's order.
  void prepare();
  /// x = A^-1 b, 3 numbers per node.
  /// @param remember  Whether later solves may start from this solution.
  dynamics::SolveStatus solve(const double* b, double* x, bool remember);
  /// Solves as solve() within a step of several solves (dynamics::StepSolves); keep() stores the last
  /// solution.
  /// @param again  Whether to start from the last solution, with a new right-hand side and new points.
  /// @param share  Admissible error as a fraction of the distance from the start.
  /// @param accurate  Out: whether the error is within the tolerance of solve().
  dynamics::SolveStatus approach(const double* b, double* x, bool again, double share, bool& accurate);
  /// Stores the last solution x for later starts.
  void keep(double* x) { put_solution(x, true, false); }
  /// Sets an absolute energy-norm error that is accepted whatever the relative tolerance.
  void allow_error(double error) { allowed_ = error * error; }

 private:
  /// Begins a right-hand side; computes the products of the earlier solutions if needed.
  void begin(bool warm);
  /// Copies b to the solver's order. Returns false if it is zero.
  bool take_right_hand_side(const double* b, bool guess);
  /// Writes the solution, held entries included, to the caller's order.
  void put_solution(double* x, bool remember, bool follow);
  dynamics::SolveStatus iterate();
  dynamics::SolveStatus iterate(double start, bool residual_is_set);
  /// Iterates in single precision and recomputes the residual in double until the error is small enough.
  dynamics::SolveStatus refine(double& rho);
  /// Returns the target relative error.
  double target_error() const;
  /// Recomputes the residual in double.
  void renew_residual();
  /// Whether the residual is at the level of rounding.
  bool at_rounding() const;

  SolveState& s_;
  double allowed_ = 0.0;      ///< squared energy-norm error
  double share_ = 0.0;        ///< share of approach()
  bool accurate_ = false;     ///< the last iteration ended within the tolerance
  Doubles Ax_;                ///< product in double
  std::vector<double> held_;  ///< right-hand sides of held directions
};

}  // namespace palpate::linear
