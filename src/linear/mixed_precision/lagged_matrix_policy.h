#pragma once

namespace palpate::linear {

/// Lagged-matrix policy: how long a matrix serves the steps after its own, and how sure that is.
///
/// A correction d = Ao^-1 r by the matrix Ao of an earlier step, where A would be right, has the residual
///     r - A d = (Ao - A) d,   an error e = A^-1 (Ao - A) d,   |e|_A = rho |d|_A.
/// Ao - A grows with the rotation and strain of bodies since, and rho with it: a step of the matrix's age
/// adds to it what the one before did, for a motion that goes on as it is (1e-3 to 6e-3 in steps of 1 ms on a
/// swinging beam of 3,700 nodes, E = 1 MPa, 5e-2 in steps of 10 ms).  d is what the solutions before did not
/// foresee, 1e-2 or less of the solution where a motion is smooth.  So e is often far below what is asked.
///
/// It is seen in the residual of the corrected solution, at the price of one more.  So it is looked at now
/// and then, and taken to be rho |d| for the next kTrusted steps, with kSafety for what is not known of it,
/// while corrections are of the size that they were of; in every other case it is looked at again, and what
/// is seen of it is taken off. A step for which it would be too large has a matrix of its own.  All this is
/// counted in steps and residuals, not in seconds: results do not depend on the machine's mood.
class LaggedMatrixPolicy {
 public:
  /// Part of a tolerance that may be left to an error which is estimated and not seen.
  static constexpr double kUnseen = 0.25;

  explicit LaggedMatrixPolicy(double rtol) : rtol_(rtol) {}

  /// Whether a next step needs no matrix of its own, as far as is known; where nothing is, it is worth a try.
  /// Begins that step.
  bool serves();
  /// The step has a matrix of its own.
  void renew() { age_ = 0; }
  /// Whether the error after a correction of this size, both over the solution's, needs no residual check.
  bool sure(double correction) const;
  /// Such an error was seen.  That of a step's own matrix is its rounding, and says nothing of its age.
  void seen(double error, double correction);
  /// Whether corrections that leave such an error shrink fast enough to go on.
  static bool converges(double error, double correction) { return error < kSlow * correction; }
  /// The step has its solution, which was foreseen up to this.
  void solved(double correction) { size_ = correction; }
  /// It has none by this matrix.
  void failed();

 private:
  static constexpr double kSafety = 2.0;
  static constexpr double kSameSize =
      2.0;  ///< how far corrections may grow from one residual check to the next
  static constexpr double kSlow = 0.1;
  static constexpr int kTrusted = 16, kForgotten = 64;  ///< steps from a residual check on

  bool small_enough(int age, double correction) const {
    return kSafety * rate_ * age * correction <= kUnseen * rtol_;
  }

  double rtol_;
  int age_ = 0;
  double rate_ = 0.0;  ///< rho, a step of age
  int since_seen_ = kForgotten;
  double seen_size_ = 0.0;  ///< of the correction then
  double size_ = 0.0;       ///< of the last one
};

}  // namespace palpate::linear
