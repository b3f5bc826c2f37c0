#pragma once
#include "palpate/core/types.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/stepper.h"

namespace palpate::integrate {

/// r(x) = 0 with a matrix A near dr/dx, as Newton's method sees it.
class NewtonEquation {
 public:
  virtual ~NewtonEquation() = default;
  /// Residual at x; false where it is not finite.
  virtual bool evaluate(const VecX& x) = 0;
  virtual bool solved() const = 0;  ///< the residual last evaluated is zero in every entry
  /// A of the iterate last evaluated, factored.
  virtual dynamics::SolveStatus refresh() = 0;
  /// d = -A^-1 r of the residual last evaluated; false where it is none.
  /// @param size  the weighted norm of d: 1 is the tolerance
  virtual bool correct(VecX& d, double& size) = 0;
  /// A correction of this size is rounding of x itself: it cannot be made smaller.
  virtual double rounding(const VecX& x) = 0;
};

struct NewtonResult {
  dynamics::StepStatus status = dynamics::StepStatus::kOk;
  int iterations = 0;
  double correction = 0.0;  ///< the last, in units of the tolerance
  const char* what = "";
  int kept = 0;  ///< of the iterations, those by the factor that was there before
};

/// Newton's method after Deuflhard (2004, sections 2.1 and 3.3): affine invariant, so neither units nor the
/// stiffness enter. With the factored matrix A of the iterate x_k, d = -A^-1 r(x_k) is the correction and,
/// after it, the simplified correction e = -A^-1 r(x_k + d), which costs a residual and a solve and no
/// factor, tells both how well it went and the remaining error:
///     contraction kappa = |e|/|d|;   converged where |e| max(1, kappa/(1 - kappa)) <= 1, and e is then added
///     too.
/// kappa > 1 - lambda/4 refuses the correction lambda d: with a fresh matrix lambda is halved (down to 1/64),
/// with an old one the matrix is made afresh.  A linear equation takes one matrix, two solves and two
/// residuals. Leaps: every correction is taken whole, whatever kappa, with a fresh matrix each.  Where the
/// residual jumps (the rotation of an element without volume, a damper at first touch) no small correction
/// descends, and a whole one may land where it is smooth.
class DampedNewton {
 public:
  enum class Way {
    kKeptMatrix,  ///< renewed where kappa > 1/2 or a correction was refused
    kFresh,       ///< a matrix at every iterate
    kLeaps,
  };
  /// @param x  first guess in, solution out   @param usable  the factor that is there may serve
  /// @returns kNotFinite, kSolverFailed or kNewtonFailed with words for it
  NewtonResult solve(NewtonEquation& equation, VecX& x, int limit, Way way, bool usable);

 private:
  double contraction_ = 0.0;  ///< last seen with this factor
  VecX d_, e_, trial_;
};

}  // namespace palpate::integrate
