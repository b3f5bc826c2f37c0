#include <arkode/arkode_erkstep.h>
#include <nvector/nvector_serial.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "integrate/error_weights.h"
#include "integrate/first_order.h"
#include "integrate/make.h"
#include "integrate/settings.h"
#include "integrate/sundials/check.h"
#include "integrate/sundials/vector_ops.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;
using sun::check;

constexpr int kOrder = 5;
constexpr int kRecoverable = 1;

StepStatus status_of(int flag) {
  switch (flag) {
    case ARK_TOO_MUCH_ACC:
    case ARK_TOO_CLOSE:
    case ARK_ILL_INPUT: return StepStatus::kBadSettings;
    case ARK_ERR_FAILURE: return StepStatus::kErrorTestFailed;
    case ARK_RHSFUNC_FAIL:
    case ARK_FIRST_RHSFUNC_ERR:
    case ARK_REPTD_RHSFUNC_ERR:
    case ARK_UNREC_RHSFUNC_ERR: return StepStatus::kNotFinite;
    default: return StepStatus::kSolverFailed;
  }
}

std::string flag_name(long flag) {
  char* owned = ERKStepGetReturnFlagName(flag);
  std::string name = owned ? owned : "UNKNOWN";
  std::free(owned);
  return name;
}

/// Explicit Runge-Kutta pair of order 5 (4) of Cash and Karp (1990) by SUNDIALS ARKODE, error control, no tangent and no
/// factorisation.  Its steps are bounded by stability, about 3.7 over the largest rate: on soft bodies its only use is as the
/// independent family that checks a reference.
class ArkErk final : public Stepper {
 public:
  ArkErk(System& system, State& state, const IntegratorSpec& spec) : state_(state), system_(system), spec_(spec), first_order_(system, state) {
    check_adaptive(spec_, kOrder);
    counters::count("integrate.ark-erk-5");
  }
  ~ArkErk() override { release(); }

  std::string name() const override { return "ark-erk-5"; }

  StepResult advance_to(double t_end) override {
    PALPATE_CHECK(t_end > state_.time(), "t_end = {} is not after t = {}", t_end, state_.time());
    if (first_order_.size() == 0) {  // no body: time passes
      state_.set_time(t_end);
      StepResult result;
      result.t = t_end;
      return result;
    }
    start();
    check(ERKStepSetStopTime(ark_, t_end), "ERKStepSetStopTime", state_.time(), 0.0);
    const double smallest = std::max(1e-12 * (t_end - state_.time()), 1e-15 * std::abs(t_end));
    check(ERKStepSetMinStep(ark_, smallest), "ERKStepSetMinStep", state_.time(), 0.0);
    message_.clear();
    double t = state_.time();
    int flag = ARK_SUCCESS;
    for (int n = 0; n < spec_.max_steps && flag >= 0 && flag != ARK_TSTOP_RETURN; ++n) {
      double reached = t;
      flag = ERKStepEvolve(ark_, t_end, y_, &reached, ARK_ONE_STEP);
      if (flag >= 0) t = reached;  // a failure gives the last good y with the time of the stage that failed
    }
    const bool landed = flag == ARK_TSTOP_RETURN;
    first_order_.store(landed ? t_end : t, NV_DATA_S(y_));
    collect_counters();
    if (landed) return result(StepStatus::kOk);
    running_ = false;
    StepResult failed = result(flag >= 0 ? StepStatus::kTooManySteps : status_of(flag));
    if (flag >= 0) message_ = fmt::format("{} steps before t_end = {}", spec_.max_steps, t_end);
    failed.message = fmt::format("ark-erk-5: {} at t = {}, h = {}: {}", flag >= 0 ? "ARK_TOO_MUCH_WORK" : flag_name(flag), t, failed.h, message_);
    return failed;
  }

  bool dense_output(double t, VecX& q, VecX& u) const override {
    if (!running_ || counted_.steps == 0 || ERKStepGetDky(ark_, t, 0, scratch_) != ARK_SUCCESS) return false;
    first_order_.finish(t, NV_DATA_S(scratch_), q, u);
    return true;
  }

  void reinit(ReinitReason) override {
    ++counters_.reinits;
    running_ = false;
  }

  const StepperCounters& counters() const override { return counters_; }

 private:
  void start() {
    if (running_) return;
    if (ark_ && layout_version_ == state_.layout().version) {
      first_order_.load(NV_DATA_S(y_));
      check(ERKStepReInit(ark_, right_hand_side, state_.time(), y_), "ERKStepReInit", state_.time(), 0.0);
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
    ark_ = ERKStepCreate(right_hand_side, t, y_, context_);
    check(ark_, "ERKStepCreate");
    check(ERKStepSetErrHandlerFn(ark_, on_error, this), "ERKStepSetErrHandlerFn", t, 0.0);  // first: nothing is ever printed
    check(ERKStepSetUserData(ark_, this), "ERKStepSetUserData", t, 0.0);
    check(ERKStepWFtolerances(ark_, weights), "ERKStepWFtolerances", t, 0.0);
    check(ERKStepSetTableNum(ark_, ARKODE_CASH_KARP_6_4_5), "ERKStepSetTableNum", t, 0.0);
    const auto& blocks = state_.layout().blocks;
    if (std::any_of(blocks.begin(), blocks.end(), [](const Block& b) { return b.kinematics != nullptr; }))
      check(ERKStepSetPostprocessStepFn(ark_, project_on_manifold), "ERKStepSetPostprocessStepFn", t, 0.0);
    layout_version_ = state_.layout().version;
  }

  void release() {
    if (ark_) ERKStepFree(&ark_);
    if (scratch_) N_VDestroy(scratch_);
    if (y_) N_VDestroy(y_);
    if (context_) SUNContext_Free(&context_);
    scratch_ = y_ = nullptr;
    context_ = nullptr;
  }

  static ArkErk& self(void* data) { return *static_cast<ArkErk*>(data); }

  static int right_hand_side(realtype t, N_Vector y, N_Vector y_dot, void* data) {
    ArkErk& me = self(data);
    return me.first_order_.derivative(t, NV_DATA_S(y), NV_DATA_S(y_dot), me.counters_) ? 0 : kRecoverable;
  }

  static int weights(N_Vector y, N_Vector w, void* data) {
    const ArkErk& me = self(data);
    error_weights(me.state_.layout(), me.spec_, me.system_.driven_mask(), NV_DATA_S(y) + me.state_.layout().q_size, NV_DATA_S(w));
    return 0;
  }

  static int project_on_manifold(realtype, N_Vector y, void* data) {
    project(self(data).state_.layout(), NV_DATA_S(y));
    return 0;
  }

  static void on_error(int, const char*, const char* function, char* text, void* data) {
    self(data).message_ = fmt::format("{}: {}", function, text);
  }

  StepResult result(StepStatus status) const {
    StepResult r;
    r.status = status;
    r.t = state_.time();
    r.order = kOrder;
    check(ERKStepGetLastStep(ark_, &r.h), "ERKStepGetLastStep", r.t, 0.0);
    return r;
  }

  /// ARKODE counts from its last start, we from ours.
  void collect_counters() {
    StepperCounters now;
    check(ERKStepGetNumSteps(ark_, &now.steps), "ERKStepGetNumSteps", 0.0, 0.0);
    check(ERKStepGetNumErrTestFails(ark_, &now.error_test_failures), "ERKStepGetNumErrTestFails", 0.0, 0.0);
    counters_.steps += now.steps - counted_.steps;
    counters_.rejected += now.error_test_failures - counted_.error_test_failures;
    counters_.error_test_failures += now.error_test_failures - counted_.error_test_failures;
    counted_ = now;
  }

  State& state_;
  System& system_;
  IntegratorSpec spec_;
  FirstOrder first_order_;
  StepperCounters counters_;
  StepperCounters counted_;  ///< ARKODE's own counts at the last look
  bool running_ = false;     ///< ARKODE's history continues the State
  std::uint64_t layout_version_ = 0;
  std::string message_;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr, scratch_ = nullptr;
  void* ark_ = nullptr;
};

}  // namespace

std::unique_ptr<Stepper> make_ark_erk(System& system, State& state, const IntegratorSpec& spec, std::unique_ptr<LinearSolver>) {
  return std::make_unique<ArkErk>(system, state, spec);
}

}  // namespace palpate::integrate
