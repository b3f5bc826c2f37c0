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
  /// An error of this size in the energy norm is small enough, whatever the relative tolerance.
  void allow_error(double error) { allowed_ = error * error; }

 private:
  dynamics::SolveStatus iterate();
  dynamics::SolveStatus refine();
  double reduction_wanted() const;
  void renew_residual();
  bool at_rounding() const;

  SolveState& s_;
  double allowed_ = 0.0;      ///< energy
  Doubles Ax_;                ///< for products in double
  std::vector<double> held_;  ///< right-hand sides of held directions
};

}  // namespace palpate::linear
