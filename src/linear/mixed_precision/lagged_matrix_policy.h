#pragma once

namespace palpate::linear {

/// Lagged-matrix policy: decides how many later steps a matrix serves, and how often its error is checked.
///
/// A correction d = Ao^-1 r with the matrix Ao of an earlier step, where A would be correct, has the residual
///     r - A d = (Ao - A) d,   an error e = A^-1 (Ao - A) d,   |e|_A = rho |d|_A.
/// Ao - A grows with the rotation and strain of bodies since, and rho with it: for a uniform motion every
/// step of the matrix's age adds the same amount to rho (1e-3 to 6e-3 in steps of 1 ms on a swinging beam of
/// 3,700 nodes, E = 1 MPa; 5e-2 in steps of 10 ms). d is the part of the solution that the initial guess from
/// earlier solutions misses, 1e-2 of the solution or less where a motion is smooth. So e is often far below
/// the tolerance.
///
/// The error is measured from the residual of the corrected solution, at the cost of one residual evaluation.
/// It is therefore measured now and then, and estimated as rho |d|, with the safety factor kSafety, for the
/// next kTrusted steps while corrections keep their size. Otherwise it is measured again, and the measured
/// error is corrected. A step whose estimated error would be too large gets a new matrix. All decisions count
/// steps and residuals, not seconds, so results do not depend on timing.
class LaggedMatrixPolicy {
 public:
  /// Fraction of the tolerance that may be taken up by an error that is estimated, not measured.
  static constexpr double kUnseen = 0.25;

  explicit LaggedMatrixPolicy(double rtol) : rtol_(rtol) {}

  /// Begins the next step and returns whether it can use the lagged matrix, by the current estimate; true
  /// where there is no recent estimate.
  bool serves();
  /// The step has a new matrix. A matrix that lacks a part of its equations counts as one of an earlier step.
  void renew(bool incomplete = false) { age_ = incomplete ? 1 : 0; }
  /// Whether the error after a correction of this size needs no residual check. Sizes are relative to the
  /// solution, in the energy norm.
  bool sure(double correction) const;
  /// Records a measured error after a correction, both relative to the solution. For a step's new matrix it
  /// is rounding and is ignored.
  void seen(double error, double correction);
  /// Whether corrections that leave this error shrink fast enough to continue.
  static bool converges(double error, double correction) { return error < kSlow * correction; }
  /// The step's solution was found; `correction` is the part that the initial guess missed, relative.
  void solved(double correction) { size_ = correction; }
  /// No solution was found with this matrix in this step.
  void failed();

 private:
  static constexpr double kSafety = 2.0;
  static constexpr double kSameSize = 2.0;  ///< most growth of corrections between residual checks
  static constexpr double kSlow = 0.1;
  static constexpr int kTrusted = 16, kForgotten = 64;  ///< steps after a residual check

  bool small_enough(int age, double correction) const {
    return kSafety * rate_ * age * correction <= kUnseen * rtol_;
  }

  double rtol_;
  int age_ = 0;
  double rate_ = 0.0;  ///< rho per step of age
  int since_seen_ = kForgotten;
  double seen_size_ = 0.0;  ///< correction at the last check
  double size_ = 0.0;       ///< last correction
};

}  // namespace palpate::linear
