#pragma once

namespace palpate::dynamics {

/// Optional capability of an iterative LinearSolver: an absolute tolerance beside its relative one.  Newton's
/// method under error control knows how large an error of a correction may be, and asks for no digit that its
/// own test does not see.  A class derives from it beside LinearSolver.
class EnergyTolerance {
 public:
  virtual ~EnergyTolerance() = default;
  /// Solves with a right-hand side of one column end, from now on, where |x - x*|_A <= error as well; 0: by
  /// the relative tolerance alone.
  virtual void allow_error(double error) = 0;
};

}  // namespace palpate::dynamics
