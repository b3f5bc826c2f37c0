#include <ida/ida.h>
#include <ida/ida_ls.h>
#include <nvector/nvector_serial.h>

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

using dynamics::SolveStatus;
using dynamics::StepStatus;
using Side = OdeProblem::Side;

constexpr int kHighestOrder = 5;

/// Backward differences of variable order and step on the residual form by SUNDIALS IDA (Hindmarsh et al.
/// 2005), fixed leading coefficient:
///     F(t_n, y_n, y'_n) = 0,  y'_n = c_j y_n + (known terms),   F = [q' - N(q) u;  M u' - f(q, u, t)].
/// No mass is inverted, so a consistent one has no additional cost (only the start needs y' and solves with M
/// once). Newton's matrix dF/dy + c_j dF/dy' is the condensed one with gamma = 1/c_j.
class Ida final : public Adapter {
 public:
  Ida(std::unique_ptr<OdeProblem> problem, const IntegratorSpec& spec) : Adapter(std::move(problem), spec) {
    check_adaptive(spec, kHighestOrder, tightest_rtol_of_bdf(spec));
    use_tolerance(error_test_rtol_of_bdf(spec));
  }
  ~Ida() override { Ida::destroy(); }

 private:
  void create() override {
    const double t = problem().time();
    y_dot_ = N_VClone(y());
    start_rate_of_change();
    memory_ = IDACreate(context());
    check(memory_, "IDACreate");
    report_errors(Solver::kIda, memory_);
    check(IDAInit(memory_, residual, t, y(), y_dot_), "IDAInit", t, 0.0);
    check(IDASetUserData(memory_, static_cast<Adapter*>(this)), "IDASetUserData", t, 0.0);
    check(IDAWFtolerances(memory_, weights), "IDAWFtolerances", t, 0.0);
    if (spec().max_order > 0) check(IDASetMaxOrd(memory_, spec().max_order), "IDASetMaxOrd", t, 0.0);
    check(IDASetMaxErrTestFails(memory_, tuning::kErrorTestFailures), "IDASetMaxErrTestFails", t, 0.0);
    check(IDASetNonlinearSolver(memory_, make_newton()), "IDASetNonlinearSolver", t, 0.0);
    use_own_test();
    linear_solver_ = make_linear_solver(*this, context());
    matrix_ = make_matrix(context());
    check(IDASetLinearSolver(memory_, linear_solver_, matrix_), "IDASetLinearSolver", t, 0.0);
    check(IDASetJacFn(memory_, jacobian), "IDASetJacFn", t, 0.0);
  }

  /// Sets y' = f(t, y), so that F = 0 at the start. Where f is not finite the first step fails and reports
  /// it.
  void start_rate_of_change() {
    if (!problem().derivative(problem().time(), NV_DATA_S(y()), NV_DATA_S(y_dot_), Side::kAll))
      N_VConst(0.0, y_dot_);
  }

  void destroy() override {
    if (memory_) IDAFree(&memory_);
    if (linear_solver_) SUNLinSolFree(linear_solver_);
    if (matrix_) SUNMatDestroy(matrix_);
    if (y_dot_) N_VDestroy(y_dot_);
    linear_solver_ = nullptr;
    matrix_ = nullptr;
    y_dot_ = nullptr;
  }

  void restart(bool) override {
    start_rate_of_change();
    check(IDAReInit(memory_, problem().time(), y(), y_dot_), "IDAReInit", problem().time(), 0.0);
  }
  void find_roots(int count) override {
    check(IDARootInit(memory_, count, event_functions), "IDARootInit", problem().time(), 0.0);
    IDASetNoInactiveRootWarn(memory_);
  }
  void aim(double t_end, double smallest_step) override {
    check(IDASetStopTime(memory_, t_end), "IDASetStopTime", problem().time(), 0.0);
    check(IDASetMinStep(memory_, smallest_step), "IDASetMinStep", problem().time(), 0.0);
  }
  int one_step(double t_end, double& t) override {
    return IDASolve(memory_, t_end, &t, y(), y_dot_, IDA_ONE_STEP);
  }

  StepStatus status_of(int flag) const override {
    switch (flag) {
      case IDA_TOO_MUCH_ACC:
      case IDA_ILL_INPUT: return StepStatus::kBadSettings;
      case IDA_ERR_FAIL: return StepStatus::kErrorTestFailed;
      case IDA_CONV_FAIL: return StepStatus::kNewtonFailed;
      case IDA_RES_FAIL:
      case IDA_REP_RES_ERR:
      case IDA_FIRST_RES_FAIL: return StepStatus::kNotFinite;
      default: return StepStatus::kSolverFailed;
    }
  }
  std::string flag_name(int flag) const override { return sun::flag_name("IDA", flag); }
  bool interpolate(double t, N_Vector out) const override {
    return IDAGetDky(memory_, t, 0, out) == IDA_SUCCESS;
  }

  Counts counts() const override {
    Counts c;
    check(IDAGetNumSteps(memory_, &c.steps), "IDAGetNumSteps", 0.0, 0.0);
    check(IDAGetNumErrTestFails(memory_, &c.error_test_failures), "IDAGetNumErrTestFails", 0.0, 0.0);
    check(IDAGetNonlinSolvStats(memory_, &c.newton_iterations, &c.newton_failures), "IDAGetNonlinSolvStats",
          0.0, 0.0);
    check(IDAGetNumStepSolveFails(memory_, &c.solve_failures), "IDAGetNumStepSolveFails", 0.0, 0.0);
    return c;
  }
  double last_step() const override {
    double h = 0.0;
    check(IDAGetLastStep(memory_, &h), "IDAGetLastStep", 0.0, 0.0);
    return h;
  }
  int last_order() const override {
    int order = 0;
    check(IDAGetLastOrder(memory_, &order), "IDAGetLastOrder", 0.0, 0.0);
    return order;
  }
  bool local_errors(N_Vector estimate) const override {
    return IDAGetEstLocalErrors(memory_, estimate) == IDA_SUCCESS;
  }
  N_Vector newton_state() const override {
    N_Vector state = nullptr;
    check(IDAGetCurrentY(memory_, &state), "IDAGetCurrentY", 0.0, 0.0);
    return state;
  }
  SolveStatus solve_newton(const double* y, const double* r, double* d) override {
    return problem().solve_residual(y, r, d);
  }

  double current_gamma() const override {
    double c_j = 1.0;
    check(IDAGetCurrentCj(memory_, &c_j), "IDAGetCurrentCj", 0.0, 0.0);
    return 1.0 / c_j;
  }

  static Ida& self(void* data) { return static_cast<Ida&>(*static_cast<Adapter*>(data)); }
  static int residual(sunrealtype t, N_Vector y, N_Vector y_dot, N_Vector r, void* data) {
    Ida& me = self(data);
    const bool finite = me.problem().residual(t, NV_DATA_S(y), NV_DATA_S(y_dot), NV_DATA_S(r));
    me.trace_evaluation(t, y, finite);
    return finite ? 0 : kRecoverable;
  }
  static int jacobian(sunrealtype t, sunrealtype c_j, N_Vector y, N_Vector, N_Vector, SUNMatrix, void* data,
                      N_Vector, N_Vector, N_Vector) {
    self(data).prepare_matrix(t, y, false, 1.0 / c_j, Side::kAll);
    return 0;
  }
  static int event_functions(sunrealtype t, N_Vector y, N_Vector, sunrealtype* g, void* data) {
    return roots(t, y, g, data);
  }

  void* memory_ = nullptr;
  N_Vector y_dot_ = nullptr;
  SUNLinearSolver linear_solver_ = nullptr;
  SUNMatrix matrix_ = nullptr;
};

}  // namespace

std::unique_ptr<dynamics::Stepper> make_ida(std::unique_ptr<OdeProblem> problem, const IntegratorSpec& spec) {
  return std::make_unique<Ida>(std::move(problem), spec);
}

}  // namespace sun

std::unique_ptr<dynamics::Stepper> make_ida(dynamics::System& system, dynamics::State& state,
                                            const IntegratorSpec& spec,
                                            std::unique_ptr<dynamics::LinearSolver> solver) {
  return sun::make_ida(std::make_unique<MechanicalProblem>(system, state, spec, std::move(solver)), spec);
}

}  // namespace palpate::integrate
