#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_mristep.h>
#include <nvector/nvector_serial.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "integrate/error_test.h"
#include "integrate/make.h"
#include "integrate/mechanical_problem.h"
#include "integrate/settings.h"
#include "integrate/sundials/adapter.h"
#include "integrate/sundials/ark_flags.h"
#include "integrate/sundials/check.h"
#include "integrate/sundials/make_adapter.h"
#include "integrate/sundials/multirate.h"
#include "integrate/sundials/step_in_parts.h"
#include "palpate/core/error.h"

namespace palpate::integrate {
namespace sun {
namespace {

using dynamics::StepStatus;
using Side = OdeProblem::Side;

/// Multi-rate infinitesimal methods of Sandu (2019) by SUNDIALS ARKODE's MRIStep: y' = f_S + f_F, the bodies
/// slow and implicit, tool and contact fast. Between two slow stages, c_i and c_(i+1), the fast side is
/// integrated with the slow one as a polynomial forcing,
///     v' = f_F(t, v) + sum_j gamma_ij(t) f_S(z_j),     z_(i+1) = v(t_n + c_(i+1) H),
/// or, where c_i = c_(i+1), an implicit stage z_(i+1) = z_i + H sum_j gbar_ij f_S(z_j) is solved by Newton's
/// method with the slow tangent only. The slow step is fixed (step_s). The fast side takes explicit steps of
/// Bogacki and Shampine under error control: cheap, because no element is evaluated in them, and bounded by
/// the rates of contact and coupling. Where a scene has neither, f_F = 0 and the method is an implicit
/// Runge-Kutta method with unnecessary overhead.
/// Stable for each side alone. Where both are stiff and coupled (a hard contact on hard tissue, at a step of
/// several periods of either) the combination need not be stable: see multirate_amplification (multirate.h).
class Mri final : public Adapter {
 public:
  Mri(std::unique_ptr<OdeProblem> problem, const IntegratorSpec& spec)
      : Adapter(std::move(problem), spec), method_(multirate_method(spec.name)) {
    check_fixed_step(spec);
    check_tightest(spec, tightest_rtol_of_mri(spec));
    use_tolerance(spec.newton_rtol);
  }
  ~Mri() override { Mri::destroy(); }

 private:
  void create() override {
    const double t = problem().time();
    create_fast(t);
    slow_ = MRIStepCreate(nullptr, slow_side, t, y(), inner_, context());
    check(slow_, "MRIStepCreate");
    report_errors(Solver::kMriStep, slow_);
    check(MRIStepSetUserData(slow_, static_cast<Adapter*>(this)), "MRIStepSetUserData", t, 0.0);
    check(MRIStepWFtolerances(slow_, weights), "MRIStepWFtolerances", t, 0.0);
    MRIStepCoupling coupling = MRIStepCoupling_LoadTable(method_.table);
    check(coupling, "MRIStepCoupling_LoadTable");
    check(MRIStepSetCoupling(slow_, coupling), "MRIStepSetCoupling", t, 0.0);
    MRIStepCoupling_Free(coupling);
    check(MRIStepSetFixedStep(slow_, spec().step_s), "MRIStepSetFixedStep", t, 0.0);
    check(MRIStepSetNonlinearSolver(slow_, make_fixed_step_newton()), "MRIStepSetNonlinearSolver", t, 0.0);
    linear_solver_ = make_linear_solver(*this, context());
    matrix_ = make_matrix(context());
    check(MRIStepSetLinearSolver(slow_, linear_solver_, matrix_), "MRIStepSetLinearSolver", t, 0.0);
    check(MRIStepSetLinSysFn(slow_, linear_system), "MRIStepSetLinSysFn", t, 0.0);
    check(MRIStepSetNonlinConvCoef(slow_, tuning::kNewtonShare), "MRIStepSetNonlinConvCoef", t, 0.0);
    if (problem().has_manifold())
      check(MRIStepSetPostprocessStepFn(slow_, project_step), "MRIStepSetPostprocessStepFn", t, 0.0);
  }

  void create_fast(double t) {
    fast_context_.emplace(on_fast_error, static_cast<Adapter*>(this));
    fast_ = ARKStepCreate(fast_side, nullptr, t, y(), *fast_context_);
    check(fast_, "ARKStepCreate");
    fast_context_->attach(Solver::kArkStep, fast_);
    check(ARKStepSetUserData(fast_, static_cast<Adapter*>(this)), "ARKStepSetUserData", t, 0.0);
    check(ARKStepWFtolerances(fast_, fast_weights), "ARKStepWFtolerances", t, 0.0);
    check(ARKStepSetTableNum(fast_, ARKODE_DIRK_NONE, ARKODE_BOGACKI_SHAMPINE_4_2_3), "ARKStepSetTableNum", t,
          0.0);
    // Between two slow stages.
    check(ARKStepSetMaxNumSteps(fast_, std::max(tuning::kLeastFastSteps, spec().max_steps)),
          "ARKStepSetMaxNumSteps", t, 0.0);
    check(ARKStepSetMaxErrTestFails(fast_, tuning::kErrorTestFailures), "ARKStepSetMaxErrTestFails", t, 0.0);
    check(ARKStepCreateMRIStepInnerStepper(fast_, &inner_), "ARKStepCreateMRIStepInnerStepper", t, 0.0);
  }

  void destroy() override {
    if (slow_) MRIStepFree(&slow_);
    if (inner_) MRIStepInnerStepper_Free(&inner_);
    if (fast_) ARKStepFree(&fast_);
    fast_context_.reset();
    if (linear_solver_) SUNLinSolFree(linear_solver_);
    if (matrix_) SUNMatDestroy(matrix_);
    inner_ = nullptr;
    linear_solver_ = nullptr;
    matrix_ = nullptr;
  }

  void restart(bool keep_step) override {
    const double t = problem().time();
    if (keep_step) return check(MRIStepReset(slow_, t, y()), "MRIStepReset", t, 0.0);
    check(ARKStepReInit(fast_, fast_side, nullptr, t, y()), "ARKStepReInit", t, 0.0);
    check(MRIStepReInit(slow_, nullptr, slow_side, t, y()), "MRIStepReInit", t, 0.0);
  }
  void find_roots(int count) override {
    check(MRIStepRootInit(slow_, count, roots), "MRIStepRootInit", problem().time(), 0.0);
    MRIStepSetNoInactiveRootWarn(slow_);
  }
  void aim(double t_end, double) override {
    check(MRIStepSetStopTime(slow_, t_end), "MRIStepSetStopTime", problem().time(), 0.0);
    now_ = problem().time();
    parts_.begin();
  }
  int one_step(double t_end, double& t) override {
    keep_state();
    for (;;) {
      check(MRIStepSetFixedStep(slow_, parts_.next(now_, t_end)), "MRIStepSetFixedStep", now_, 0.0);
      allow_leaps(parts_.halved());
      begin_part(parts_.halvings());
      at_start_ = true;
      const int flag = MRIStepEvolve(slow_, t_end, y(), &t, ARK_ONE_STEP);
      fast_context_->log_warnings();
      if (flag >= 0) now_ = t;
      end_part(flag >= 0);
      if (flag != ARK_CONV_FAILURE) return flag;
      ++failures_;
      if (!parts_.shorten(now_)) return flag;
      restore_state();
      check(MRIStepReset(slow_, now_, y()), "MRIStepReset", now_, 0.0);
      check(MRIStepSetStopTime(slow_, t_end), "MRIStepSetStopTime", now_, 0.0);
    }
  }

  StepStatus status_of(int flag) const override {
    return flag == ARK_INNERSTEP_FAIL ? StepStatus::kErrorTestFailed : ark_status(flag);
  }
  std::string flag_name(int flag) const override { return sun::flag_name("MRIStep", flag); }
  std::string remedy(int flag) const override {
    if (flag == ARK_INNERSTEP_FAIL) return "  " + fast_message_;
    return flag == ARK_CONV_FAILURE
               ? fmt::format("  Not even a step of h/{} converges: decrease step_s", 1 << tuning::kHalvings)
               : std::string();
  }
  bool interpolate(double t, N_Vector out) const override {
    return MRIStepGetDky(slow_, t, 0, out) == ARK_SUCCESS;
  }

  Counts counts() const override {
    Counts c;
    check(MRIStepGetNumSteps(slow_, &c.steps), "MRIStepGetNumSteps", 0.0, 0.0);
    check(MRIStepGetNonlinSolvStats(slow_, &c.newton_iterations, &c.newton_failures),
          "MRIStepGetNonlinSolvStats", 0.0, 0.0);
    c.solve_failures = failures_;
    check(ARKStepGetNumSteps(fast_, &c.fast_steps), "ARKStepGetNumSteps", 0.0, 0.0);
    return c;
  }
  double last_step() const override {
    double h = 0.0;
    check(MRIStepGetLastStep(slow_, &h), "MRIStepGetLastStep", 0.0, 0.0);
    return h;
  }
  int last_order() const override { return method_.order; }
  N_Vector newton_state() const override {
    N_Vector state = nullptr;
    check(MRIStepGetCurrentState(slow_, &state), "MRIStepGetCurrentState", 0.0, 0.0);
    return state;
  }
  double current_gamma() const override {
    double gamma = 0.0;
    check(MRIStepGetCurrentGamma(slow_, &gamma), "MRIStepGetCurrentGamma", 0.0, 0.0);
    return gamma;
  }

  static void on_fast_error(const char*, const char* text, void* data) {
    self(data).fast_message_ = fmt::format("Fast part: {}", text);
  }
  static Mri& self(void* data) { return static_cast<Mri&>(*static_cast<Adapter*>(data)); }
  static int slow_side(sunrealtype t, N_Vector y, N_Vector y_dot, void* data) {
    Mri& me = self(data);
    if (std::exchange(me.at_start_, false) && t == me.now_) evaluate_start(me.slow_, t, me.scratch());
    const bool finite = me.problem().derivative(t, NV_DATA_S(y), NV_DATA_S(y_dot), Side::kSlow);
    me.trace_evaluation(t, y, finite);
    return finite ? 0 : kRecoverable;
  }
  static int fast_side(sunrealtype t, N_Vector y, N_Vector y_dot, void* data) {
    Mri& me = self(data);
    if (me.interrupted()) return kUnrecoverable;  // A slow step may contain a hundred thousand fast ones.
    const bool finite = me.problem().derivative(t, NV_DATA_S(y), NV_DATA_S(y_dot), Side::kFast);
    me.trace_evaluation(t, y, finite);
    return finite ? 0 : kRecoverable;
  }
  static int fast_weights(N_Vector y, N_Vector w, void* data) {
    self(data).problem().weights(NV_DATA_S(y), NV_DATA_S(w));
    N_VScale(1.0 / tuning::kFastShare, w, w);
    return 0;
  }
  static int linear_system(sunrealtype t, N_Vector y, N_Vector, SUNMatrix, SUNMatrix, sunbooleantype reuse,
                           sunbooleantype* fresh, sunrealtype gamma, void* data, N_Vector, N_Vector,
                           N_Vector) {
    *fresh = self(data).prepare_matrix(t, y, reuse, gamma, Side::kSlow);
    return 0;
  }

  const MultirateMethod& method_;
  double now_ = 0.0;
  bool at_start_ = false;  ///< At the start of a step, before the first evaluation.
  StepInParts parts_{spec().step_s};
  /// Separate, so that its errors are distinguished from errors of the slow side.
  std::optional<Context> fast_context_;
  std::string fast_message_;
  long failures_ = 0;  ///< Failed solves of a stage, which the library does not count.
  void *slow_ = nullptr, *fast_ = nullptr;
  MRIStepInnerStepper inner_ = nullptr;
  SUNLinearSolver linear_solver_ = nullptr;
  SUNMatrix matrix_ = nullptr;
};

}  // namespace

std::unique_ptr<dynamics::Stepper> make_mri(std::unique_ptr<OdeProblem> problem, const IntegratorSpec& spec) {
  return std::make_unique<Mri>(std::move(problem), spec);
}

}  // namespace sun

std::unique_ptr<dynamics::Stepper> make_mri(dynamics::System& system, dynamics::State& state,
                                            const IntegratorSpec& spec,
                                            std::unique_ptr<dynamics::LinearSolver> solver) {
  return sun::make_mri(std::make_unique<MechanicalProblem>(system, state, spec, std::move(solver)), spec);
}

}  // namespace palpate::integrate
