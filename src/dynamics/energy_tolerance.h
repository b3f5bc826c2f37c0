#pragma once

namespace palpate::dynamics {

/// Optional capability of an iterative LinearSolver: an absolute tolerance in addition to its relative one.
/// In Newton's method under error control the acceptable error of a correction is known; digits below its
/// convergence test need not be computed. A class inherits it in addition to LinearSolver.
class EnergyTolerance {
 public:
  virtual ~EnergyTolerance() = default;
  /// Sets the absolute tolerance of later solves with one right-hand side: they also stop where |x - x*|_A <=
  /// error. 0: relative tolerance only.
  virtual void allow_error(double error) = 0;
};

}  // namespace palpate::dynamics
