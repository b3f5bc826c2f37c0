#include <fmt/format.h>

#include "simbody_body.h"
#include "tick_scheme.h"

namespace palpate::tool {
namespace {

/// Accuracy for Simbody's local error control (RMS over the 13 coordinates and velocities, in SI units).
constexpr double kAccuracy = 1e-10;
/// Limit of internal steps per tick.
constexpr int kMaxSteps = 100000;

// Semi-explicit Euler, two steps of h compared with one step of 2 h:
//   u1 = u0 + h u'(q0, u0),     q1 = q0 + h N(q0) u1,     and again from (q1, u1), which gives y2;
//   ub = u0 + 2 h u'(q0, u0),   qb = q0 + 2 h N(q0) ub,   which is yb.
// y2 - yb = h^2 (u'', ..) + O(h^3) estimates the error of y2, which is kept (no extrapolation). Simbody
// scales it by a speed that is not small, and a coupling that oscillates at w has |u''| = w^2 |u|. A local
// error T therefore permits steps 2 h ~ 2 sqrt(T)/w, and t/2h steps accumulate a
//   relative error ~ w t sqrt(T)/2     for     w/(2 sqrt(T)) steps per second.
// For w = 100/s and t = 0.1 s (the damping time):
//   T = 1e-10   relative error 5e-5   5,000 steps per tick of 1 ms
//   T = 1e-6    relative error 5e-3      50 steps per tick of 1 ms   (measured at w = 2e4/s: 9,000 per tick)
// Hence 1e-6: two to three digits, compared with eight for the other two integrators. A tick whose
// oscillation needs more than kFirstOrderMaxSteps steps ends with an error.
constexpr double kFirstOrderAccuracy = 1e-6;
constexpr int kFirstOrderMaxSteps = 20000;

/// Scheme with one of Simbody's integrators, which stops exactly at the end of each tick. If the input
/// changes between ticks, the next tick begins with a reinitialisation (a multistep method then restarts at
/// order 1), after which stepTo may return without a step; hence the loop.
class ErrorControlled : public TickScheme {
 public:
  ErrorControlled(SimbodyBody& body, std::unique_ptr<SimTK::Integrator> integrator,
                  double accuracy = kAccuracy, int max_steps = kMaxSteps)
      : body_(body), integrator_(std::move(integrator)), max_steps_(max_steps) {
    integrator_->setAccuracy(accuracy);
    integrator_->setInternalStepLimit(max_steps);
  }

  dynamics::StepResult advance(const TickInput& input, RigidMotion& motion) override {
    const double target = input.t0 + input.h;
    dynamics::StepResult result{
        dynamics::StepStatus::kOk, target, input.h, integrator_->getMethodMinOrder(), 0, 0.0, {}};
    try {
      start(input, motion);
      const int before = integrator_->getNumStepsTaken();
      while (integrator_->getTime() < target) {
        if (integrator_->stepTo(target, target) == SimTK::Integrator::ReachedStepLimit)
          return too_many(input);
      }
      result.iterations = integrator_->getNumStepsTaken() - before;
      if (result.iterations > 0) result.h = integrator_->getPreviousStepSizeTaken();
      motion = body_.read(integrator_->getState());
    } catch (const std::exception& e) {  // Simbody throws if a step fails.
      reset();
      result.status = dynamics::StepStatus::kErrorTestFailed;
      result.t = input.t0;
      result.message = fmt::format("{} at t = {:.9g} s, tick {:.3g} s: {}", integrator_->getMethodName(),
                                   input.t0, input.h, e.what());
    }
    return result;
  }
  void reset() override { fresh_ = true; }

 private:
  void start(const TickInput& input, const RigidMotion& motion) {
    if (!fresh_ && same_wrench(input, input_)) return;
    input_ = input;
    if (!fresh_) {
      body_.set_input(integrator_->updAdvancedState(), input);
      integrator_->reinitialize(SimTK::Stage::Dynamics, false);
      return;
    }
    SimTK::State state = body_.default_state();
    body_.write(state, input.t0, motion);
    body_.set_input(state, input);
    integrator_->initialize(state);
    fresh_ = false;
  }

  dynamics::StepResult too_many(const TickInput& input) {
    reset();
    return {dynamics::StepStatus::kTooManySteps,
            input.t0,
            input.h,
            integrator_->getMethodMinOrder(),
            max_steps_,
            0.0,
            fmt::format("{} at t = {:.9g} s: more than {} steps in a tick of {:.3g} s: the tool rotates or "
                        "oscillates too fast for the accuracy of {:g}; use tool.integrator = "
                        "\"linearly-implicit-euler\", which has no step limit, or a softer coupling",
                        integrator_->getMethodName(), input.t0, max_steps_, input.h,
                        integrator_->getAccuracyInUse())};
  }

  SimbodyBody& body_;
  std::unique_ptr<SimTK::Integrator> integrator_;
  int max_steps_;
  TickInput input_;  ///< Input set in the integrator's state.
  bool fresh_ = true;
};

}  // namespace

std::unique_ptr<TickScheme> make_runge_kutta_merson(SimbodyBody& body) {
  return std::make_unique<ErrorControlled>(
      body, std::make_unique<SimTK::RungeKuttaMersonIntegrator>(body.system()));
}
std::unique_ptr<TickScheme> make_semi_explicit_euler2(SimbodyBody& body) {
  return std::make_unique<ErrorControlled>(
      body, std::make_unique<SimTK::SemiExplicitEuler2Integrator>(body.system()), kFirstOrderAccuracy,
      kFirstOrderMaxSteps);
}
std::unique_ptr<TickScheme> make_cpodes(SimbodyBody& body) {
  return std::make_unique<ErrorControlled>(body, std::make_unique<SimTK::CPodesIntegrator>(body.system()));
}

}  // namespace palpate::tool
