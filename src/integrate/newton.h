#pragma once
#include "palpate/core/types.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/stepper.h"

namespace palpate::integrate {

/// Nonlinear equation r(x) = 0 with a matrix A that approximates dr/dx, for Newton's method.
class NewtonEquation {
 public:
  virtual ~NewtonEquation() = default;
  /// Evaluates the residual at x; returns false where it is not finite.
  virtual bool evaluate(const VecX& x) = 0;
  virtual bool solved() const = 0;  ///< Returns whether the residual last evaluated is zero in every entry.
  /// Evaluates and factors A at the iterate last evaluated.
  virtual dynamics::SolveStatus refresh() = 0;
  /// Computes d = -A^-1 r for the residual last evaluated; returns false where the solve fails.
  /// @param size  weighted norm of d, where 1 is the tolerance
  virtual bool correct(VecX& d, double& size) = 0;
  /// Returns the size of a correction that is rounding of x, and therefore cannot be reduced.
  virtual double rounding(const VecX& x) = 0;
};

/// Result of a nonlinear solve.
struct NewtonResult {
  dynamics::StepStatus status = dynamics::StepStatus::kOk;
  int iterations = 0;
  double correction = 0.0;  ///< Last correction, in units of the tolerance.
  /// Reason of a failure, in words.
  const char* what = "";
  int kept = 0;  ///< Number of iterations with the factor of an earlier solve.
};

/// Newton's method after Deuflhard (2004, sections 2.1 and 3.3). It is affine invariant: units and stiffness
/// do not enter. With the factored matrix A at the iterate x_k, d = -A^-1 r(x_k) is the correction. The
/// simplified correction e = -A^-1 r(x_k + d) costs a residual and a solve but no factorisation; it measures
/// the contraction and the remaining error:
///     contraction kappa = |e|/|d|;   converged where |e| max(1, kappa/(1 - kappa)) <= 1, with e added too.
/// kappa > 1 - lambda/4 rejects the correction lambda d: with a fresh matrix lambda is halved (down to 1/64),
/// with an old one the matrix is renewed. A linear equation takes one matrix, two solves and two residuals.
/// Way::kLeaps takes every correction undamped, whatever kappa, with a fresh matrix each. Where the residual
/// is discontinuous (the rotation of an element without volume, a damper at first contact) no small
/// correction descends, while a full one may reach a region where it is smooth.
class DampedNewton {
 public:
  enum class Way {
    kKeptMatrix,  ///< Renewed where kappa > 1/2 or a correction was rejected.
    kFresh,       ///< A new matrix at every iterate.
    /// Every correction undamped, with a fresh matrix each.
    kLeaps,
  };
  /// Solves for x.
  /// @param x  initial guess on entry, solution on return
  /// @param limit  largest number of iterations
  /// @param usable  the factor of an earlier solve may be used
  /// @returns kNotFinite, kSolverFailed or kNewtonFailed with a reason
  NewtonResult solve(NewtonEquation& equation, VecX& x, int limit, Way way, bool usable);

 private:
  double contraction_ = 0.0;  ///< Last observed with this factor.
  VecX d_, e_, trial_;
};

}  // namespace palpate::integrate
