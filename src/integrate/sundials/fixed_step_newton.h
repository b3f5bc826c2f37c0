#pragma once
#include <sundials/sundials_nonlinearsolver.h>

#include "integrate/newton.h"
#include "integrate/sundials/hidden.h"
#include "integrate/sundials/hooks.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// Nonlinear solver of SUNDIALS for fixed steps, which cannot be shortened after a failure. The library's
/// Newton solver keeps one tangent for all iterations, takes every correction undamped, and where that fails
/// requires a shorter step. Where contact closes within the step the tangent at the start does not contain
/// it, and undamped corrections alternate across the kink. This solver is DampedNewton in the unknown of the
/// library (the correction of its predicted stage), with the library's residual, weights and tolerance; the
/// factor is kept while it converges. Where this fails the solve is repeated once from the prediction, with
/// definite tangents, renewed in every iteration.
class FixedStepNewton : private NewtonEquation {
 public:
  explicit FixedStepNewton(NewtonHook& hook) : hook_(hook) {}
  ~FixedStepNewton() override;
  FixedStepNewton(const FixedStepNewton&) = delete;
  FixedStepNewton& operator=(const FixedStepNewton&) = delete;

  /// Makes the SUNNonlinearSolver, which refers to this object.
  SUNNonlinearSolver make(SUNContext context);
  /// Sets whether a solve without descent is repeated with undamped corrections. Over a whole step these
  /// would often find a solution of much higher energy; in parts of a step they seldom do.
  void allow_leaps(bool on) { leaps_ = on; }
  void release();  ///< Frees the vectors, before the context is destroyed.

 private:
  int solve(N_Vector correction, N_Vector weights, double tolerance, bool set_up, void* memory);
  bool evaluate(const VecX& x) override;
  bool solved() const override;
  dynamics::SolveStatus refresh() override;
  bool correct(VecX& d, double& size) override;
  double rounding(const VecX& x) override;

  NewtonHook& hook_;
  DampedNewton newton_;
  SUNNonlinSolSysFn system_ = nullptr;
  SUNNonlinSolLSetupFn set_up_ = nullptr;
  SUNNonlinSolLSolveFn solve_ = nullptr;
  bool usable_ = false, leaps_ = false;

  // State of the last solve, or of the current one.
  int iterations_ = 0;
  bool failed_ = false;
  int flag_ = 0;  ///< Flag of the library's functions; < 0: unrecoverable.
  N_Vector x_ = nullptr, residual_ = nullptr, step_ = nullptr, weights_ = nullptr;
  double tolerance_ = 1.0;
  void* memory_ = nullptr;

  friend struct Operations;
};

}  // namespace sun
}  // namespace palpate::integrate
