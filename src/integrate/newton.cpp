#include "integrate/newton.h"

#include "integrate/tuning.h"

namespace palpate::integrate {

using dynamics::SolveStatus;
using dynamics::StepStatus;

namespace {

/// Returns a bound of the error after a correction of this size at this contraction (geometric series), at
/// least the correction.
double left_over(double correction, double contraction) {
  return correction * std::max(1.0, contraction < 0.95 ? contraction / (1.0 - contraction) : 20.0);
}

}  // namespace

NewtonResult DampedNewton::solve(NewtonEquation& equation, VecX& x, int limit, Way way, bool usable) {
  const bool every_time = way != Way::kKeptMatrix;
  bool earlier = !every_time && usable;  // The current factor is from an earlier solve.
  int kept = 0;
  const auto failed = [&](StepStatus status, int iterations, double correction, const char* what) {
    return NewtonResult{status, iterations, correction, what, kept};
  };
  const auto converged = [&](double correction, double contraction) {
    return left_over(correction, contraction) <= 1.0 || correction <= equation.rounding(x);
  };
  if (!equation.evaluate(x)) return failed(StepStatus::kNotFinite, 0, 0.0, "the force is not finite");
  if (equation.solved()) return {};
  bool fresh = every_time || !usable;
  double size = 0.0;
  if (fresh) contraction_ = 0.0;
  if ((fresh && equation.refresh() != SolveStatus::kOk) || !equation.correct(d_, size))
    return failed(StepStatus::kSolverFailed, 0, 0.0, "the step matrix is singular or not finite");
  for (int k = 1; k <= limit; ++k) {
    kept += earlier;
    if (converged(size, contraction_)) {
      x += d_;
      return {StepStatus::kOk, k, size, "", kept};
    }
    double lambda = 1.0, next = 0.0, kappa = 0.0;
    bool taken = false;
    for (; !taken && lambda >= tuning::kSmallestDamping; lambda /= 2.0) {
      trial_ = x + lambda * d_;
      if (equation.evaluate(trial_)) {
        if (!equation.correct(e_, next))
          return failed(StepStatus::kSolverFailed, k, size, "the step matrix is singular or not finite");
        kappa = next / size;
        taken = way == Way::kLeaps || next <= 1.0 || next <= equation.rounding(trial_) ||
                kappa <= 1.0 - lambda / 4.0;
      }
      if (!taken && !fresh) break;
    }
    if (!taken && fresh)
      return failed(StepStatus::kNewtonFailed, k, size, "Newton line search found no descent");
    if (taken) {
      x = trial_;
      contraction_ = kappa;
      if (converged(next, kappa)) {
        x += e_;
        return {StepStatus::kOk, k, next, "", kept};
      }
    } else if (!equation.evaluate(x)) {  // The old matrix gave no descent: back to x.
      return failed(StepStatus::kNotFinite, k, size, "the force is not finite");
    }
    if (every_time || !taken || kappa > tuning::kSlowContraction) {
      fresh = true;
      earlier = false;
      const double seen = taken ? kappa : 0.0;
      if (equation.refresh() != SolveStatus::kOk || !equation.correct(d_, size))
        return failed(StepStatus::kSolverFailed, k, next, "the step matrix is singular or not finite");
      contraction_ = seen;  // The effect of the fresh matrix is observed after its first correction.
    } else {
      fresh = false;
      d_.swap(e_);
      size = next;
    }
  }
  return failed(StepStatus::kNewtonFailed, limit, size, "Newton did not converge");
}

}  // namespace palpate::integrate
