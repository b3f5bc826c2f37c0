#include <arkode/arkode_arkstep.h>
#include <nvector/nvector_serial.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "integrate/error_test.h"
#include "integrate/make.h"
#include "integrate/mechanical_problem.h"
#include "integrate/settings.h"
#include "integrate/sundials/adapter.h"
#include "integrate/sundials/ark_flags.h"
#include "integrate/sundials/ark_methods.h"
#include "integrate/sundials/check.h"
#include "integrate/sundials/make_adapter.h"
#include "integrate/sundials/step_in_parts.h"

namespace palpate::integrate {
namespace sun {
namespace {

using dynamics::StepControl;
using dynamics::StepStatus;
using Side = OdeProblem::Side;

constexpr int kInterpolantDegree = 3;  ///< Cubic Hermite: needs no additional evaluation.
/// The next step starts from the state at a root: worth two evaluations.
constexpr int kRootDegree = 5;
/// Runge-Kutta methods of SUNDIALS ARKODE (Reynolds et al. 2023): explicit, diagonally implicit, or additive
/// (stiff terms implicit, the others explicit), by the tables of ark_methods.cpp; step by error control, or
/// step_s with fixed_step. One-step methods: after an external change they restart without loss, with the
/// previous step size.
class Ark final : public Adapter {
 public:
  Ark(std::unique_ptr<OdeProblem> problem, const IntegratorSpec& spec)
      : Adapter(std::move(problem), spec),
        method_(ark_method(spec.name)),
        implicit_side_(method_.explicit_table >= 0 ? Side::kImplicit : Side::kAll) {
    if (spec.fixed_step)
      check_fixed_step(spec);
    else
      check_adaptive(spec, method_.traits.order, tightest_rtol_of_ark(spec));
    use_tolerance(tolerance_of(spec));
  }
  ~Ark() override { Ark::destroy(); }

 private:
  /// With a fixed step the weights are used by Newton's method only, and newton_rtol replaces rtol.
  static double tolerance_of(const IntegratorSpec& spec) {
    return spec.fixed_step ? spec.newton_rtol : error_test_rtol_of_ark(spec);
  }
  /// Returns Newton's share of the tolerance. Where the pair's tolerance T is above rtol, the share is
  /// taken of rtol: the propagated solution is more accurate than T, and must not be degraded by its stages.
  static double newton_share(const IntegratorSpec& spec) {
    const double aim = spec.fixed_step ? spec.newton_rtol : spec.rtol;
    return tuning::kNewtonShare * std::min(1.0, aim / tolerance_of(spec));
  }

  bool has_implicit() const { return method_.implicit_table >= 0; }
  bool has_explicit() const { return method_.explicit_table >= 0; }
  ARKRhsFn explicit_function() const {
    return !has_explicit() ? nullptr : has_implicit() ? explicit_side : whole;
  }
  ARKRhsFn implicit_function() const {
    return !has_implicit() ? nullptr : has_explicit() ? implicit_side : whole;
  }

  void create() override {
    const double t = problem().time();
    memory_ = ARKStepCreate(explicit_function(), implicit_function(), t, y(), context());
    check(memory_, "ARKStepCreate");
    report_errors(Solver::kArkStep, memory_);
    check(ARKStepSetUserData(memory_, static_cast<Adapter*>(this)), "ARKStepSetUserData", t, 0.0);
    check(ARKStepWFtolerances(memory_, weights), "ARKStepWFtolerances", t, 0.0);
    check(set_tables(memory_, static_cast<ARKODE_DIRKTableID>(method_.implicit_table),
                     static_cast<ARKODE_ERKTableID>(method_.explicit_table), problem().has_manifold()),
          "ARKStepSetTableNum", t, 0.0);
    check(ARKStepSetInterpolantDegree(
              memory_, spec().events == KinkTreatment::kRootFinding ? kRootDegree : kInterpolantDegree),
          "ARKStepSetInterpolantDegree", t, 0.0);
    check(ARKStepSetMaxErrTestFails(memory_, tuning::kErrorTestFailures), "ARKStepSetMaxErrTestFails", t,
          0.0);
    if (problem().has_manifold())
      check(ARKStepSetPostprocessStepFn(memory_, project_step), "ARKStepSetPostprocessStepFn", t, 0.0);
    if (has_implicit()) use_newton(t);
  }

  void use_newton(double t) {
    check(ARKStepSetNonlinearSolver(memory_, spec().fixed_step ? make_fixed_step_newton() : make_newton()),
          "ARKStepSetNonlinearSolver", t, 0.0);
    if (!spec().fixed_step) use_own_test();
    linear_solver_ = make_linear_solver(*this, context());
    matrix_ = make_matrix(context());
    check(ARKStepSetLinearSolver(memory_, linear_solver_, matrix_), "ARKStepSetLinearSolver", t, 0.0);
    check(ARKStepSetLinSysFn(memory_, linear_system), "ARKStepSetLinSysFn", t, 0.0);
    check(ARKStepSetMaxNonlinIters(memory_, tuning::kArkNewtonIterations), "ARKStepSetMaxNonlinIters", t,
          0.0);
    check(ARKStepSetNonlinConvCoef(memory_, newton_share(spec())), "ARKStepSetNonlinConvCoef", t, 0.0);
    // Computes f of a stage from its equation: saves evaluations.
    check(ARKStepSetDeduceImplicitRhs(memory_, SUNTRUE), "ARKStepSetDeduceImplicitRhs", t, 0.0);
  }

  void destroy() override {
    if (memory_) ARKStepFree(&memory_);
    if (linear_solver_) SUNLinSolFree(linear_solver_);
    if (matrix_) SUNMatDestroy(matrix_);
    linear_solver_ = nullptr;
    matrix_ = nullptr;
  }

  void restart(bool keep_step) override {
    const double t = problem().time();
    if (!keep_step)
      return check(ARKStepReInit(memory_, explicit_function(), implicit_function(), t, y()), "ARKStepReInit",
                   t, 0.0);
    check(ARKStepReset(memory_, t, y()), "ARKStepReset", t, 0.0);
  }
  void find_roots(int count) override {
    check(ARKStepRootInit(memory_, count, roots), "ARKStepRootInit", problem().time(), 0.0);
    ARKStepSetNoInactiveRootWarn(memory_);
  }
  void aim(double t_end, double smallest_step) override {
    check(ARKStepSetStopTime(memory_, t_end), "ARKStepSetStopTime", problem().time(), 0.0);
    if (!spec().fixed_step)
      check(ARKStepSetMinStep(memory_, smallest_step), "ARKStepSetMinStep", problem().time(), 0.0);
    now_ = problem().time();
    parts_.begin();
  }

  int one_step(double t_end, double& t) override {
    if (spec().fixed_step) return one_fixed_step(t_end, t);
    const bool halfway = aim_halfway(t_end);
    const int flag = ARKStepEvolve(memory_, t_end, y(), &t, ARK_ONE_STEP);
    if (flag >= 0) now_ = t;
    return halfway && flag == ARK_TSTOP_RETURN ? ARK_SUCCESS : flag;
  }

  int one_fixed_step(double t_end, double& t) {
    keep_state();
    for (;;) {
      check(ARKStepSetFixedStep(memory_, parts_.next(now_, t_end)), "ARKStepSetFixedStep", now_, 0.0);
      allow_leaps(parts_.halved());
      begin_part(parts_.halvings());
      const int flag = ARKStepEvolve(memory_, t_end, y(), &t, ARK_ONE_STEP);
      if (flag >= 0) now_ = t;
      end_part(flag >= 0);
      if (flag != ARK_CONV_FAILURE || !parts_.shorten(now_)) return flag;
      restore_state();
      check(ARKStepReset(memory_, now_, y()), "ARKStepReset", now_, 0.0);
      check(ARKStepSetStopTime(memory_, t_end), "ARKStepSetStopTime", now_, 0.0);
    }
  }

  /// Splits the rest of the interval into two equal steps, where one full step and a part of one are left. A
  /// very short last step would degrade the next one: f of its last stage is deduced from (z - known) / (h
  /// a_ii), with an error of rounding / h, and multiplied by the full h of the step that follows.
  /// If the stop time would be passed, ARKODE shortens the step to h (1 - 4 eps), and its controller then
  /// proposes that h again: the second half, which misses the stop time by rounding. It lands there
  /// nevertheless, as on each stop time that a step misses by less than kLanding (|t| + h), so that such a
  /// rest is one step. If it were halved, it would be halved again at each step, until the controller lets h
  /// grow.
  bool aim_halfway(double t_end) {
    constexpr double kLanding = 100.0 * std::numeric_limits<double>::epsilon();
    double next = 0.0;
    check(ARKStepGetCurrentStep(memory_, &next), "ARKStepGetCurrentStep", now_, 0.0);
    const double left = t_end - now_, reach = next + kLanding * (std::abs(t_end) + next);
    const bool halfway = next > 0.0 && reach < left && left < 2.0 * next;
    check(ARKStepSetStopTime(memory_, halfway ? now_ + 0.5 * left : t_end), "ARKStepSetStopTime", now_, next);
    return halfway;
  }

  StepStatus status_of(int flag) const override { return ark_status(flag); }
  std::string flag_name(int flag) const override { return sun::flag_name("ARKStep", flag); }
  /// With a fixed step no accuracy was requested: the solution is out of proportion to the weights.
  std::string remedy(int flag) const override {
    if (flag == ARK_CONV_FAILURE && spec().fixed_step)
      return fmt::format("  Not even a step of h/{} converges: decrease step_s, or use error control",
                         1 << tuning::kHalvings);
    if (flag != ARK_TOO_MUCH_ACC || !spec().fixed_step) return {};
    return has_implicit()
               ? "  The solution diverges at this fixed step: decrease step_s, or use error control"
               : "  The solution diverges: step_s of an explicit method must be below its stability limit";
  }
  bool interpolate(double t, N_Vector out) const override {
    return ARKStepGetDky(memory_, t, 0, out) == ARK_SUCCESS;
  }

  Counts counts() const override {
    Counts c;
    check(ARKStepGetNumSteps(memory_, &c.steps), "ARKStepGetNumSteps", 0.0, 0.0);
    check(ARKStepGetNumErrTestFails(memory_, &c.error_test_failures), "ARKStepGetNumErrTestFails", 0.0, 0.0);
    check(ARKStepGetNonlinSolvStats(memory_, &c.newton_iterations, &c.newton_failures),
          "ARKStepGetNonlinSolvStats", 0.0, 0.0);
    check(ARKStepGetNumStepSolveFails(memory_, &c.solve_failures), "ARKStepGetNumStepSolveFails", 0.0, 0.0);
    return c;
  }
  double last_step() const override {
    double h = 0.0;
    check(ARKStepGetLastStep(memory_, &h), "ARKStepGetLastStep", 0.0, 0.0);
    return h;
  }
  int last_order() const override { return method_.traits.order; }
  bool local_errors(N_Vector estimate) const override {
    return !spec().fixed_step && ARKStepGetEstLocalErrors(memory_, estimate) == ARK_SUCCESS;
  }
  N_Vector newton_state() const override {
    N_Vector state = nullptr;
    check(ARKStepGetCurrentState(memory_, &state), "ARKStepGetCurrentState", 0.0, 0.0);
    return state;
  }

  double current_gamma() const override {
    double gamma = 0.0;
    check(ARKStepGetCurrentGamma(memory_, &gamma), "ARKStepGetCurrentGamma", 0.0, 0.0);
    return gamma;
  }

  static Ark& self(void* data) { return static_cast<Ark&>(*static_cast<Adapter*>(data)); }
  template <Side side>
  static int evaluate(sunrealtype t, N_Vector y, N_Vector y_dot, void* data) {
    Ark& me = self(data);
    const bool finite = me.problem().derivative(t, NV_DATA_S(y), NV_DATA_S(y_dot), side);
    me.trace_evaluation(t, y, finite);
    return finite ? 0 : kRecoverable;
  }
  static int whole(sunrealtype t, N_Vector y, N_Vector y_dot, void* data) {
    return evaluate<Side::kAll>(t, y, y_dot, data);
  }
  static int implicit_side(sunrealtype t, N_Vector y, N_Vector y_dot, void* data) {
    return evaluate<Side::kImplicit>(t, y, y_dot, data);
  }
  static int explicit_side(sunrealtype t, N_Vector y, N_Vector y_dot, void* data) {
    return evaluate<Side::kExplicit>(t, y, y_dot, data);
  }
  static int linear_system(sunrealtype t, N_Vector y, N_Vector, SUNMatrix, SUNMatrix, sunbooleantype reuse,
                           sunbooleantype* fresh, sunrealtype gamma, void* data, N_Vector, N_Vector,
                           N_Vector) {
    Ark& me = self(data);
    *fresh = me.prepare_matrix(t, y, reuse, gamma, me.implicit_side_);
    return 0;
  }

  const ArkMethod& method_;
  Side implicit_side_;
  double now_ = 0.0;
  StepInParts parts_{spec().step_s};
  void* memory_ = nullptr;
  SUNLinearSolver linear_solver_ = nullptr;
  SUNMatrix matrix_ = nullptr;
};

}  // namespace

std::unique_ptr<dynamics::Stepper> make_ark(std::unique_ptr<OdeProblem> problem, const IntegratorSpec& spec) {
  return std::make_unique<Ark>(std::move(problem), spec);
}

}  // namespace sun

std::unique_ptr<dynamics::Stepper> make_ark(dynamics::System& system, dynamics::State& state,
                                            const IntegratorSpec& spec,
                                            std::unique_ptr<dynamics::LinearSolver> solver) {
  return sun::make_ark(std::make_unique<MechanicalProblem>(system, state, spec, std::move(solver)), spec);
}

}  // namespace palpate::integrate
