#include "integrate/sundials/fixed_step_newton.h"

#include <nvector/nvector_serial.h>

#include <cmath>

#include "core/finite.h"
#include "integrate/sundials/check.h"
#include "integrate/sundials/release.h"
#include "integrate/tuning.h"

namespace palpate::integrate::sun {

using dynamics::SolveStatus;
using dynamics::StepStatus;

namespace {

Eigen::Map<VecX> entries(N_Vector v) { return {NV_DATA_S(v), NV_LENGTH_S(v)}; }

}  // namespace

/// Function table of SUNNonlinearSolver.
struct Operations {
  static FixedStepNewton& of(SUNNonlinearSolver solver) {
    return *static_cast<FixedStepNewton*>(solver->content);
  }
  static SUNNonlinearSolver_Type type(SUNNonlinearSolver) { return SUNNONLINEARSOLVER_ROOTFIND; }
  static int ready(SUNNonlinearSolver) { return kSuccess; }
  static int solve(SUNNonlinearSolver s, N_Vector, N_Vector correction, N_Vector weights,
                   sunrealtype tolerance, sunbooleantype set_up, void* memory) {
    return of(s).solve(correction, weights, tolerance, set_up, memory);
  }
  static int set_system(SUNNonlinearSolver s, SUNNonlinSolSysFn f) {
    of(s).system_ = f;
    return kSuccess;
  }
  static int set_set_up(SUNNonlinearSolver s, SUNNonlinSolLSetupFn f) {
    of(s).set_up_ = f;
    return kSuccess;
  }
  static int set_solve(SUNNonlinearSolver s, SUNNonlinSolLSolveFn f) {
    of(s).solve_ = f;
    return kSuccess;
  }
  // The test of Deuflhard is used instead.
  static int no_test(SUNNonlinearSolver, SUNNonlinSolConvTestFn, void*) { return kSuccess; }
  static int no_limit(SUNNonlinearSolver, int) { return kSuccess; }
  // Returns the iterations of the last solve; the library sums them.
  template <class Count>
  static int iterations(SUNNonlinearSolver s, Count* n) {
    *n = of(s).iterations_;
    return kSuccess;
  }
  static int failures(SUNNonlinearSolver s, long* n) {
    *n = of(s).failed_;
    return kSuccess;
  }
  static int free(SUNNonlinearSolver s) {
    s->content = nullptr;  // Owned by the FixedStepNewton.
    SUNNonlinSolFreeEmpty(s);
    return kSuccess;
  }
};

SUNNonlinearSolver FixedStepNewton::make(SUNContext context) {
  SUNNonlinearSolver solver = SUNNonlinSolNewEmpty(context);
  check(solver, "SUNNonlinSolNewEmpty");
  solver->content = this;
  solver->ops->gettype = Operations::type;
  solver->ops->initialize = Operations::ready;
  solver->ops->solve = Operations::solve;
  solver->ops->free = Operations::free;
  solver->ops->setsysfn = Operations::set_system;
  solver->ops->setlsetupfn = Operations::set_set_up;
  solver->ops->setlsolvefn = Operations::set_solve;
  solver->ops->setctestfn = Operations::no_test;
  solver->ops->setmaxiters = Operations::no_limit;
  solver->ops->getnumiters = Operations::iterations<long>;
  solver->ops->getcuriter = Operations::iterations<int>;
  solver->ops->getnumconvfails = Operations::failures;
  usable_ = false;
  return solver;
}

FixedStepNewton::~FixedStepNewton() { release(); }

void FixedStepNewton::release() {
  for (N_Vector* v : {&x_, &residual_, &step_}) {
    if (*v) N_VDestroy(*v);
    *v = nullptr;
  }
}

int FixedStepNewton::solve(N_Vector correction, N_Vector weights, double tolerance, bool set_up,
                           void* memory) {
  for (N_Vector* v : {&x_, &residual_, &step_})
    if (!*v) *v = N_VClone(correction);
  weights_ = weights;
  tolerance_ = tolerance;
  memory_ = memory;
  flag_ = 0;
  if (set_up) usable_ = false;
  const VecX first = entries(correction);
  VecX x = first;
  NewtonResult result =
      newton_.solve(*this, x, tuning::kNewtonIterations, DampedNewton::Way::kKeptMatrix, usable_);
  iterations_ = result.iterations;
  const int kept = result.kept;
  bool definite = false, leapt = false;
  if (result.status != StepStatus::kOk && flag_ >= 0) {
    x = first;
    definite = true;
    hook_.project_to_psd(true);
    result = newton_.solve(*this, x, tuning::kDefiniteIterations, DampedNewton::Way::kFresh, false);
    hook_.project_to_psd(false);
    usable_ = false;  // The next solve uses the true tangent.
    iterations_ += result.iterations;
  }
  if (result.status != StepStatus::kOk && flag_ >= 0 && leaps_) {
    x = first;
    leapt = true;
    result = newton_.solve(*this, x, tuning::kDefiniteIterations, DampedNewton::Way::kLeaps, false);
    iterations_ += result.iterations;
  }
  entries(correction) = x;
  hook_.record_solve(kept, definite, leapt);
  failed_ = result.status != StepStatus::kOk;
  if (!failed_) return kSuccess;
  return flag_ < 0 ? flag_ : SUN_NLS_CONV_RECVR;
}

bool FixedStepNewton::evaluate(const VecX& x) {
  entries(x_) = x;
  const int flag = system_(x_, residual_, memory_);
  flag_ = std::min(flag_, flag);
  return flag == 0 && all_finite(entries(residual_));
}

bool FixedStepNewton::solved() const { return (entries(residual_).array() == 0.0).all(); }

/// Returns the rounding of the stage's value: the unknown is a correction to its prediction.
double FixedStepNewton::rounding(const VecX&) {
  const N_Vector stage = hook_.iterate();
  return stage ? tuning::kRounding * N_VWrmsNorm(stage, weights_) / tolerance_ : 0.0;
}

SolveStatus FixedStepNewton::refresh() {
  sunbooleantype current = SUNFALSE;
  const int flag = set_up_(SUNTRUE, &current, memory_);  // At the state that the library evaluated last.
  flag_ = std::min(flag_, flag);
  usable_ = flag == 0;
  return usable_ ? SolveStatus::kOk : SolveStatus::kSingular;
}

bool FixedStepNewton::correct(VecX& d, double& size) {
  N_VScale(-1.0, residual_, step_);
  const int flag = solve_(step_, memory_);
  flag_ = std::min(flag_, flag);
  if (flag != 0) return false;
  d = entries(step_);
  size = N_VWrmsNorm(step_, weights_) / tolerance_;
  return std::isfinite(size);
}

}  // namespace palpate::integrate::sun
