#include <fmt/format.h>

#include "simbody_body.h"
#include "tick_scheme.h"

namespace palpate::tool {
namespace {

/// Local error that Simbody keeps (RMS over the 13 coordinates and velocities, in SI units).
constexpr double kAccuracy = 1e-10;
/// Internal steps a tick before giving up.
constexpr int kMaxSteps = 100000;

/// One of Simbody's own integrators, landing on the end of each tick.  The input changes between ticks, so each begins with a
/// reinitialisation; after one, stepTo may return at once without a step, hence the loop.
class ErrorControlled : public TickScheme {
 public:
  ErrorControlled(SimbodyBody& body, std::unique_ptr<SimTK::Integrator> integrator) : body_(body), integrator_(std::move(integrator)) {
    integrator_->setAccuracy(kAccuracy);
    integrator_->setInternalStepLimit(kMaxSteps);
  }

  dynamics::StepResult advance(const TickInput& input, RigidMotion& motion) override {
    const double target = input.t0 + input.h;
    dynamics::StepResult result{dynamics::StepStatus::kOk, target, input.h, integrator_->getMethodMinOrder(), 0, 0.0, {}};
    try {
      start(input, motion);
      const int before = integrator_->getNumStepsTaken();
      while (integrator_->getTime() < target) {
        if (integrator_->stepTo(target, target) == SimTK::Integrator::ReachedStepLimit) return too_many(input);
      }
      result.iterations = integrator_->getNumStepsTaken() - before;
      if (result.iterations > 0) result.h = integrator_->getPreviousStepSizeTaken();
      motion = body_.read(integrator_->getState());
    } catch (const std::exception& e) {  // Simbody throws where a step fails
      reset();
      result.status = dynamics::StepStatus::kErrorTestFailed;
      result.t = input.t0;
      result.message = fmt::format("{} at t = {:.9g} s, tick {:.3g} s: {}", integrator_->getMethodName(), input.t0, input.h, e.what());
    }
    return result;
  }
  void reset() override { fresh_ = true; }

 private:
  void start(const TickInput& input, const RigidMotion& motion) {
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
    return {dynamics::StepStatus::kTooManySteps, input.t0, input.h, integrator_->getMethodMinOrder(), kMaxSteps, 0.0,
            fmt::format("{} at t = {:.9g} s: more than {} steps in a tick of {:.3g} s", integrator_->getMethodName(), input.t0, kMaxSteps, input.h)};
  }

  SimbodyBody& body_;
  std::unique_ptr<SimTK::Integrator> integrator_;
  bool fresh_ = true;
};

}  // namespace

std::unique_ptr<TickScheme> make_runge_kutta_merson(SimbodyBody& body) {
  return std::make_unique<ErrorControlled>(body, std::make_unique<SimTK::RungeKuttaMersonIntegrator>(body.system()));
}
std::unique_ptr<TickScheme> make_cpodes(SimbodyBody& body) {
  return std::make_unique<ErrorControlled>(body, std::make_unique<SimTK::CPodesIntegrator>(body.system()));
}

}  // namespace palpate::tool
