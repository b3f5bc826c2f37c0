#pragma once
#include <sundials/sundials_nonlinearsolver.h>

#include "integrate/newton.h"
#include "integrate/sundials/hidden.h"
#include "integrate/sundials/hooks.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// A nonlinear solver of SUNDIALS for fixed steps: a step that cannot be shortened must be solved from
/// where it starts. The library's own Newton keeps one tangent for all iterations, takes every correction
/// whole, and where that fails asks for a shorter step.  Where contact closes within the step the tangent
/// of the start knows nothing of it, and a whole correction leaps to and fro over the kink.  Here it is
/// DampedNewton in the unknown of the library (the correction of its predicted stage), with the library's
/// residual, weights and tolerance; the factor is kept while it serves. Where that fails it is tried once
/// more from the prediction, with a definite tangent and a fresh one in every iteration.
class FixedStepNewton : private NewtonEquation {
 public:
  explicit FixedStepNewton(NewtonHook& hook) : hook_(hook) {}
  ~FixedStepNewton() override;
  FixedStepNewton(const FixedStepNewton&) = delete;
  FixedStepNewton& operator=(const FixedStepNewton&) = delete;

  SUNNonlinearSolver make(SUNContext context);
  /// Whether a solve that finds no descent leaps.  Over a whole step that would often find a solution of
  /// much more energy; in parts of one it seldom does.
  void allow_leaps(bool on) { leaps_ = on; }
  void release();  ///< its vectors, before the context goes

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

  // of the last solve, or the one under way
  int iterations_ = 0;
  bool failed_ = false;
  int flag_ = 0;  ///< of the library's functions; < 0: given up
  N_Vector x_ = nullptr, residual_ = nullptr, step_ = nullptr, weights_ = nullptr;
  double tolerance_ = 1.0;
  void* memory_ = nullptr;

  friend struct Operations;
};

}  // namespace sun
}  // namespace palpate::integrate
