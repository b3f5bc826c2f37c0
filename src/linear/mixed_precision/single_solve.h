#pragma once
#include <vector>

#include "linear/mixed_precision/solve_state.h"

namespace palpate::linear {

/// Solves with the matrix that a SingleMatrix holds: conjugate gradients in single precision, corrected by
/// residuals in double (single_pcg.cpp).
class SingleSolve {
 public:
  explicit SingleSolve(SolveState& state) : s_(state) {}

  /// Memory for the copy's order.
  void prepare();
  /// x = A^-1 b, 3 a node.  @param remember  as a solution to start from
  dynamics::SolveStatus solve(const double* b, double* x, bool remember);
  /// The same within a step of several solves (dynamics::StepSolves), of which keep() remembers the last.
  /// @param again  from the last solution on, with another right-hand side and other points
  /// @param share  of the way from there that the error may be
  /// @param accurate  whether the error is within the tolerance of solve()
  dynamics::SolveStatus approach(const double* b, double* x, bool again, double share, bool& accurate);
  /// Remembers the last solution.  @param x  it
  void keep(double* x) { put_solution(x, true, false); }
  /// An error of this size in the energy norm is small enough, whatever the relative tolerance.
  void allow_error(double error) { allowed_ = error * error; }

 private:
  void begin(bool warm);
  bool take_right_hand_side(const double* b, bool guess);
  void put_solution(double* x, bool remember, bool follow);
  dynamics::SolveStatus iterate();
  dynamics::SolveStatus iterate(double start, bool residual_is_set);
  dynamics::SolveStatus refine(double& rho);
  double reduction_wanted() const;
  void renew_residual();
  bool at_rounding() const;

  SolveState& s_;
  double allowed_ = 0.0;      ///< energy
  double share_ = 0.0;        ///< of approach()
  bool accurate_ = false;     ///< the last iteration ended within the tolerance
  Doubles Ax_;                ///< for products in double
  std::vector<double> held_;  ///< right-hand sides of held directions
};

}  // namespace palpate::linear
