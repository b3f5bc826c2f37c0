#include <cvode/cvode.h>
#include <cvode/cvode_ls.h>
#include <cvode/cvode_proj.h>
#include <nvector/nvector_serial.h>

#include <algorithm>
#include <cmath>

#include "integrate/condensed_newton.h"
#include "integrate/error_weights.h"
#include "integrate/first_order.h"
#include "integrate/make.h"
#include "integrate/settings.h"
#include "integrate/sundials/check.h"
#include "integrate/sundials/hooks.h"
#include "integrate/sundials/vector_ops.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;
using sun::check;

constexpr int kHighestOrder = 5;
/// A force that jumps (a damper at first touch) makes the step shrink by ten a failure, down to where the jump is below the tolerance;
/// CVODE's own limit of 7 gives up at rtol 1e-8.  smallest_step bounds it in any case.
constexpr int kErrorTestFailures = 30;
constexpr int kRecoverable = 1;

/// A step that collapses to this ends the call with an error: before a force that is not finite from some time on,
/// steps would shrink towards that time without end.  Far below any physical time scale, above the rounding of t.
double smallest_step(double t, double t_end) { return std::max(1e-12 * (t_end - t), 1e-15 * std::max(std::abs(t), std::abs(t_end))); }

StepStatus status_of(int flag) {
  switch (flag) {
    case CV_TOO_MUCH_ACC:
    case CV_TOO_CLOSE:
    case CV_ILL_INPUT: return StepStatus::kBadSettings;
    case CV_ERR_FAILURE: return StepStatus::kErrorTestFailed;
    case CV_CONV_FAILURE: return StepStatus::kNewtonFailed;
    case CV_RHSFUNC_FAIL:
    case CV_FIRST_RHSFUNC_ERR:
    case CV_REPTD_RHSFUNC_ERR:
    case CV_UNREC_RHSFUNC_ERR: return StepStatus::kNotFinite;
    default: return StepStatus::kSolverFailed;
  }
}

/// Variable-order, variable-step backward differences of SUNDIALS CVODE (Hindmarsh et al. 2005, Gardner et al. 2022), Newton by CondensedNewton.
/// The tangent is taken afresh at every factorisation: it costs a fifteenth of one, and spares a failed Newton solve.
/// Where CVODE would accept an old tangent and gamma is unchanged, the old factor is kept.
/// Steps are free between two outputs; the last one is shortened to land on t_end.
class CvodeBdf final : public Stepper, private sun::NewtonHook {
 public:
  CvodeBdf(System& system, State& state, const IntegratorSpec& spec, std::unique_ptr<LinearSolver> solver)
      : system_(system), state_(state), spec_(spec), first_order_(system, state), newton_(system, std::move(solver), spec) {
    check_adaptive(spec_, kHighestOrder);
    counters::count("integrate.cvode-bdf");
  }
  ~CvodeBdf() override { release(); }

  std::string name() const override { return "cvode-bdf"; }

  StepResult advance_to(double t_end) override {
    PALPATE_CHECK(t_end > state_.time(), "t_end = {} is not after t = {}", t_end, state_.time());
    if (first_order_.size() == 0) {  // no body: time passes
      state_.set_time(t_end);
      StepResult result;
      result.t = t_end;
      return result;
    }
    start();
    check(CVodeSetStopTime(cvode_, t_end), "CVodeSetStopTime", state_.time(), 0.0);
    check(CVodeSetMinStep(cvode_, smallest_step(state_.time(), t_end)), "CVodeSetMinStep", state_.time(), 0.0);
    message_.clear();
    double t = state_.time();
    int flag = CV_SUCCESS;
    for (int n = 0; n < spec_.max_steps && flag >= 0 && flag != CV_TSTOP_RETURN; ++n) {
      newton_before_ = newton_iterations();
      flag = CVode(cvode_, t_end, y_, &t, CV_ONE_STEP);
    }
    const bool landed = flag == CV_TSTOP_RETURN;
    first_order_.store(landed ? t_end : t, NV_DATA_S(y_));
    collect_counters();
    if (landed) return result(StepStatus::kOk);
    if (flag >= 0) message_ = fmt::format("{} steps before t_end = {}", spec_.max_steps, t_end);
    running_ = false;  // the next call starts from the State
    StepResult failed = result(flag >= 0 ? StepStatus::kTooManySteps : status_of(flag));
    failed.message = fmt::format("cvode-bdf: {} at t = {}, h = {}: {}", flag >= 0 ? "CV_TOO_MUCH_WORK" : sun::cvode_flag_name(flag), t, failed.h, message_);
    return failed;
  }

  bool dense_output(double t, VecX& q, VecX& u) const override {
    if (!running_ || counted_.steps == 0 || CVodeGetDky(cvode_, t, 0, scratch_) != CV_SUCCESS) return false;
    first_order_.finish(t, NV_DATA_S(scratch_), q, u);
    return true;
  }

  void reinit(ReinitReason) override {
    ++counters_.reinits;
    running_ = false;
  }

  const StepperCounters& counters() const override {
    newton_.solver().report(counters_);
    return counters_;
  }

 private:
  // --- life of CVODE's memory -------------------------------------------------------------------------------------
  void start() {
    if (running_) return;
    if (cvode_ && layout_version_ == state_.layout().version) {
      first_order_.load(NV_DATA_S(y_));
      check(CVodeReInit(cvode_, state_.time(), y_), "CVodeReInit", state_.time(), 0.0);
    } else {
      release();
      create();
    }
    counted_ = {};
    running_ = true;
  }

  void create() {
    const double t = state_.time();
    check(SUNContext_Create(nullptr, &context_), "SUNContext_Create", t, 0.0);
    y_ = N_VNew_Serial(first_order_.size(), context_);
    check(y_, "N_VNew_Serial");
    sun::use_fast_operations(y_);
    scratch_ = N_VClone(y_);
    first_order_.load(NV_DATA_S(y_));
    cvode_ = CVodeCreate(CV_BDF, context_);
    check(cvode_, "CVodeCreate");
    check(CVodeSetErrHandlerFn(cvode_, on_error, this), "CVodeSetErrHandlerFn", t, 0.0);  // first: nothing is ever printed
    check(CVodeInit(cvode_, right_hand_side, t, y_), "CVodeInit", t, 0.0);
    check(CVodeSetUserData(cvode_, this), "CVodeSetUserData", t, 0.0);
    check(CVodeWFtolerances(cvode_, weights), "CVodeWFtolerances", t, 0.0);
    if (spec_.max_order > 0) check(CVodeSetMaxOrd(cvode_, spec_.max_order), "CVodeSetMaxOrd", t, 0.0);
    check(CVodeSetMaxErrTestFails(cvode_, kErrorTestFailures), "CVodeSetMaxErrTestFails", t, 0.0);
    linear_solver_ = sun::make_linear_solver(*this, context_);
    matrix_ = sun::make_matrix(context_);
    check(CVodeSetLinearSolver(cvode_, linear_solver_, matrix_), "CVodeSetLinearSolver", t, 0.0);
    check(CVodeSetLinSysFn(cvode_, linear_system), "CVodeSetLinSysFn", t, 0.0);
    const auto& blocks = state_.layout().blocks;
    if (std::any_of(blocks.begin(), blocks.end(), [](const Block& b) { return b.kinematics != nullptr; })) {
      check(CVodeSetProjFn(cvode_, project_on_manifold), "CVodeSetProjFn", t, 0.0);
      check(CVodeSetProjErrEst(cvode_, SUNFALSE), "CVodeSetProjErrEst", t, 0.0);
    }
    layout_version_ = state_.layout().version;
  }

  void release() {
    if (cvode_) CVodeFree(&cvode_);
    if (linear_solver_) SUNLinSolFree(linear_solver_);
    if (matrix_) SUNMatDestroy(matrix_);
    if (scratch_) N_VDestroy(scratch_);
    if (y_) N_VDestroy(y_);
    if (context_) SUNContext_Free(&context_);
    linear_solver_ = nullptr;
    matrix_ = nullptr;
    scratch_ = y_ = nullptr;
    context_ = nullptr;
  }

  // --- what CVODE calls -------------------------------------------------------------------------------------------
  static CvodeBdf& self(void* data) { return *static_cast<CvodeBdf*>(data); }

  static int right_hand_side(realtype t, N_Vector y, N_Vector y_dot, void* data) {
    CvodeBdf& me = self(data);
    return me.first_order_.derivative(t, NV_DATA_S(y), NV_DATA_S(y_dot), me.counters_) ? 0 : kRecoverable;
  }

  static int weights(N_Vector y, N_Vector w, void* data) {
    const CvodeBdf& me = self(data);
    error_weights(me.state_.layout(), me.spec_, me.system_.driven_mask(), NV_DATA_S(y) + me.state_.layout().q_size, NV_DATA_S(w));
    return 0;
  }

  /// @param reuse  CVODE takes the matrices of an earlier call, if their gamma is brought up to date
  static int linear_system(realtype t, N_Vector y, N_Vector, SUNMatrix, booleantype reuse, booleantype* fresh, realtype gamma, void* data,
                           N_Vector, N_Vector, N_Vector) {
    CvodeBdf& me = self(data);
    me.wanted_gamma_ = gamma;
    *fresh = !(reuse && gamma == me.newton_.gamma());
    if (*fresh) me.newton_.evaluate(me.first_order_.view(t, NV_DATA_S(y)), me.counters_);
    return 0;
  }

  int setup() override { return newton_.factor(wanted_gamma_) == SolveStatus::kOk ? 0 : kRecoverable; }

  int solve(N_Vector x, N_Vector b) override {
    N_Vector y = nullptr;
    check(CVodeGetCurrentState(cvode_, &y), "CVodeGetCurrentState", 0.0, 0.0);
    const int nq = state_.layout().q_size;
    const double* r = NV_DATA_S(b);
    double* d = NV_DATA_S(x);
    const SolveStatus status = newton_.solve(state_.layout(), NV_DATA_S(y), r, r + nq, d, d + nq);
    check(CVodeGetErrWeights(cvode_, scratch_), "CVodeGetErrWeights", 0.0, 0.0);
    last_correction_ = N_VWrmsNorm(x, scratch_);
    return status == SolveStatus::kOk ? 0 : kRecoverable;
  }

  static int project_on_manifold(realtype, N_Vector y, N_Vector correction, realtype, N_Vector, void* data) {
    const Layout& layout = self(data).state_.layout();
    N_VScale(1.0, y, correction);
    project(layout, NV_DATA_S(correction));
    N_VLinearSum(1.0, correction, -1.0, y, correction);
    return 0;
  }

  static void on_error(int, const char*, const char* function, char* text, void* data) {
    self(data).message_ = fmt::format("{}: {}", function, text);
  }

  // --- what is told -----------------------------------------------------------------------------------------------
  long newton_iterations() const {
    long n = 0;
    check(CVodeGetNumNonlinSolvIters(cvode_, &n), "CVodeGetNumNonlinSolvIters", 0.0, 0.0);
    return n;
  }

  StepResult result(StepStatus status) const {
    StepResult r;
    r.status = status;
    r.t = state_.time();
    check(CVodeGetLastStep(cvode_, &r.h), "CVodeGetLastStep", r.t, 0.0);
    check(CVodeGetLastOrder(cvode_, &r.order), "CVodeGetLastOrder", r.t, r.h);
    r.iterations = static_cast<int>(newton_iterations() - newton_before_);
    r.residual = last_correction_;
    return r;
  }

  /// CVODE counts from its last start, we from ours.
  void collect_counters() {
    StepperCounters now;
    long solve_failures = 0;
    check(CVodeGetNumSteps(cvode_, &now.steps), "CVodeGetNumSteps", 0.0, 0.0);
    check(CVodeGetNumErrTestFails(cvode_, &now.error_test_failures), "CVodeGetNumErrTestFails", 0.0, 0.0);
    check(CVodeGetNonlinSolvStats(cvode_, &now.newton_iterations, &now.newton_failures), "CVodeGetNonlinSolvStats", 0.0, 0.0);
    check(CVodeGetNumStepSolveFails(cvode_, &solve_failures), "CVodeGetNumStepSolveFails", 0.0, 0.0);
    now.rejected = now.error_test_failures + solve_failures;
    counters_.steps += now.steps - counted_.steps;
    counters_.rejected += now.rejected - counted_.rejected;
    counters_.error_test_failures += now.error_test_failures - counted_.error_test_failures;
    counters_.newton_iterations += now.newton_iterations - counted_.newton_iterations;
    counters_.newton_failures += now.newton_failures - counted_.newton_failures;
    counted_ = now;
  }

  System& system_;
  State& state_;
  IntegratorSpec spec_;
  FirstOrder first_order_;
  CondensedNewton newton_;
  mutable StepperCounters counters_;
  StepperCounters counted_;      ///< CVODE's own counts at the last look
  double wanted_gamma_ = 0.0;
  double last_correction_ = 0.0; ///< weighted norm of the last Newton correction
  long newton_before_ = 0;
  bool running_ = false;         ///< CVODE's history continues the State
  std::uint64_t layout_version_ = 0;
  std::string message_;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr, scratch_ = nullptr;
  SUNLinearSolver linear_solver_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  void* cvode_ = nullptr;
};

}  // namespace

std::unique_ptr<Stepper> make_cvode_bdf(System& system, State& state, const IntegratorSpec& spec, std::unique_ptr<LinearSolver> solver) {
  return std::make_unique<CvodeBdf>(system, state, spec, std::move(solver));
}

}  // namespace palpate::integrate
