#include <cvode/cvode.h>
#include <cvode/cvode_ls.h>
#include <cvode/cvode_proj.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "integrate/error_test.h"
#include "integrate/make.h"
#include "integrate/mechanical_problem.h"
#include "integrate/settings.h"
#include "integrate/sundials/adapter.h"
#include "integrate/sundials/check.h"
#include "integrate/sundials/make_adapter.h"

namespace palpate::integrate {
namespace sun {
namespace {

using dynamics::StepStatus;
using Side = OdeProblem::Side;

constexpr int kHighestBdf = 5, kHighestAdams = 12;

/// Linear multistep methods of variable order and step by SUNDIALS CVODE (Hindmarsh et al. 2005, Gardner et
/// al. 2022), in the fixed-leading-coefficient form
///     sum_i alpha_i y_{n-i} + h beta_0 f(t_n, y_n) + h sum_i beta_i f_{n-i} = 0.
/// BDF: i = 0..k, k <= 5; A-stable for k <= 2, A(alpha)-stable above: undamped modes that h does not resolve
/// can grow from order 3 on (to avoid this, max_order = 2). Newton's method with the condensed matrix.
/// Adams-Moulton: k <= 12, solved by fixed-point iteration: no tangent; steps are bounded by about 1 /
/// (largest rate).
class Cvode final : public Adapter {
 public:
  Cvode(std::unique_ptr<OdeProblem> problem, const IntegratorSpec& spec, int method)
      : Adapter(std::move(problem), spec), method_(method) {
    if (method == CV_BDF)
      check_adaptive(spec, kHighestBdf, tightest_rtol_of_bdf(spec));
    else
      check_adaptive(spec, kHighestAdams, tightest_rtol_of_adams(spec));
    use_tolerance(method == CV_BDF ? error_test_rtol_of_bdf(spec) : error_test_rtol_of_adams(spec));
  }
  ~Cvode() override { Cvode::destroy(); }

 private:
  void create() override {
    const double t = problem().time();
    memory_ = CVodeCreate(method_, context());
    check(memory_, "CVodeCreate");
    report_errors(Solver::kCvode, memory_);
    check(CVodeInit(memory_, right_hand_side, t, y()), "CVodeInit", t, 0.0);
    check(CVodeSetUserData(memory_, static_cast<Adapter*>(this)), "CVodeSetUserData", t, 0.0);
    check(CVodeWFtolerances(memory_, weights), "CVodeWFtolerances", t, 0.0);
    if (spec().max_order > 0) check(CVodeSetMaxOrd(memory_, spec().max_order), "CVodeSetMaxOrd", t, 0.0);
    check(CVodeSetMaxErrTestFails(memory_, tuning::kErrorTestFailures), "CVodeSetMaxErrTestFails", t, 0.0);
    if (method_ == CV_BDF)
      use_newton(t);
    else
      use_fixed_point(t);
    if (!problem().has_manifold() || method_ != CV_BDF) return;
    check(CVodeSetProjFn(memory_, project_on_manifold), "CVodeSetProjFn", t, 0.0);  // BDF only.
    check(CVodeSetProjErrEst(memory_, SUNFALSE), "CVodeSetProjErrEst", t, 0.0);
  }

  void use_newton(double t) {
    check(CVodeSetNonlinearSolver(memory_, make_newton()), "CVodeSetNonlinearSolver", t, 0.0);
    use_own_test();
    check(CVodeSetMaxNonlinIters(memory_, tuning::kCvodeNewtonIterations), "CVodeSetMaxNonlinIters", t, 0.0);
    linear_solver_ = make_linear_solver(*this, context());
    matrix_ = make_matrix(context());
    check(CVodeSetLinearSolver(memory_, linear_solver_, matrix_), "CVodeSetLinearSolver", t, 0.0);
    check(CVodeSetLinSysFn(memory_, linear_system), "CVodeSetLinSysFn", t, 0.0);
  }

  void use_fixed_point(double t) {
    nonlinear_solver_ = SUNNonlinSol_FixedPoint(y(), 0, context());
    check(nonlinear_solver_, "SUNNonlinSol_FixedPoint");
    check(CVodeSetNonlinearSolver(memory_, nonlinear_solver_), "CVodeSetNonlinearSolver", t, 0.0);
    use_own_test(nonlinear_solver_);
    check(CVodeSetMaxNonlinIters(memory_, tuning::kFixedPointIterations), "CVodeSetMaxNonlinIters", t, 0.0);
  }

  void destroy() override {
    if (memory_) CVodeFree(&memory_);
    if (linear_solver_) SUNLinSolFree(linear_solver_);
    if (nonlinear_solver_) SUNNonlinSolFree(nonlinear_solver_);
    if (matrix_) SUNMatDestroy(matrix_);
    linear_solver_ = nullptr;
    nonlinear_solver_ = nullptr;
    matrix_ = nullptr;
  }

  void restart(bool) override {
    check(CVodeReInit(memory_, problem().time(), y()), "CVodeReInit", problem().time(), 0.0);
  }
  void find_roots(int count) override {
    check(CVodeRootInit(memory_, count, roots), "CVodeRootInit", problem().time(), 0.0);
    CVodeSetNoInactiveRootWarn(memory_);
  }
  void aim(double t_end, double smallest_step) override {
    check(CVodeSetStopTime(memory_, t_end), "CVodeSetStopTime", problem().time(), 0.0);
    check(CVodeSetMinStep(memory_, smallest_step), "CVodeSetMinStep", problem().time(), 0.0);
  }
  int one_step(double t_end, double& t) override { return CVode(memory_, t_end, y(), &t, CV_ONE_STEP); }

  StepStatus status_of(int flag) const override {
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
  std::string flag_name(int flag) const override { return sun::flag_name("CVode", flag); }
  bool interpolate(double t, N_Vector out) const override {
    return CVodeGetDky(memory_, t, 0, out) == CV_SUCCESS;
  }

  Counts counts() const override {
    Counts c;
    check(CVodeGetNumSteps(memory_, &c.steps), "CVodeGetNumSteps", 0.0, 0.0);
    check(CVodeGetNumErrTestFails(memory_, &c.error_test_failures), "CVodeGetNumErrTestFails", 0.0, 0.0);
    check(CVodeGetNonlinSolvStats(memory_, &c.newton_iterations, &c.newton_failures),
          "CVodeGetNonlinSolvStats", 0.0, 0.0);
    check(CVodeGetNumStepSolveFails(memory_, &c.solve_failures), "CVodeGetNumStepSolveFails", 0.0, 0.0);
    return c;
  }
  double last_step() const override {
    double h = 0.0;
    check(CVodeGetLastStep(memory_, &h), "CVodeGetLastStep", 0.0, 0.0);
    return h;
  }
  int last_order() const override {
    int order = 0;
    check(CVodeGetLastOrder(memory_, &order), "CVodeGetLastOrder", 0.0, 0.0);
    return order;
  }
  bool local_errors(N_Vector estimate) const override {
    return CVodeGetEstLocalErrors(memory_, estimate) == CV_SUCCESS;
  }
  N_Vector newton_state() const override {
    N_Vector state = nullptr;
    check(CVodeGetCurrentState(memory_, &state), "CVodeGetCurrentState", 0.0, 0.0);
    return state;
  }

  double current_gamma() const override {
    double gamma = 0.0;
    check(CVodeGetCurrentGamma(memory_, &gamma), "CVodeGetCurrentGamma", 0.0, 0.0);
    return gamma;
  }

  static Cvode& self(void* data) { return static_cast<Cvode&>(*static_cast<Adapter*>(data)); }
  static int right_hand_side(sunrealtype t, N_Vector y, N_Vector y_dot, void* data) {
    Cvode& me = self(data);
    const bool finite = me.problem().derivative(t, NV_DATA_S(y), NV_DATA_S(y_dot), Side::kAll);
    me.trace_evaluation(t, y, finite);
    return finite ? 0 : kRecoverable;
  }
  static int linear_system(sunrealtype t, N_Vector y, N_Vector, SUNMatrix, sunbooleantype reuse,
                           sunbooleantype* fresh, sunrealtype gamma, void* data, N_Vector, N_Vector,
                           N_Vector) {
    *fresh = self(data).prepare_matrix(t, y, reuse, gamma, Side::kAll);
    return 0;
  }
  static int project_on_manifold(sunrealtype, N_Vector y, N_Vector correction, sunrealtype, N_Vector,
                                 void* data) {
    N_VScale(1.0, y, correction);
    self(data).problem().project(NV_DATA_S(correction));
    N_VLinearSum(1.0, correction, -1.0, y, correction);
    return 0;
  }

  int method_;
  void* memory_ = nullptr;
  SUNLinearSolver linear_solver_ = nullptr;
  SUNNonlinearSolver nonlinear_solver_ = nullptr;
  SUNMatrix matrix_ = nullptr;
};

}  // namespace

std::unique_ptr<dynamics::Stepper> make_cvode(std::unique_ptr<OdeProblem> problem,
                                              const IntegratorSpec& spec) {
  return std::make_unique<Cvode>(std::move(problem), spec, spec.name == "cvode-adams" ? CV_ADAMS : CV_BDF);
}

}  // namespace sun

std::unique_ptr<dynamics::Stepper> make_cvode(dynamics::System& system, dynamics::State& state,
                                              const IntegratorSpec& spec,
                                              std::unique_ptr<dynamics::LinearSolver> solver) {
  return sun::make_cvode(std::make_unique<MechanicalProblem>(system, state, spec, std::move(solver)), spec);
}

}  // namespace palpate::integrate
