#pragma once
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <map>
#include <thread>

#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"

/// Linearly implicit Euler with one injected defect, which the stability matrix must find. It has the name of
/// this method, whose formula it is compared with, or of the method that it claims to be.
namespace palpate::faulty {

enum class Defect {
  kNothing,
  kNotANumber,
  kGainsEnergy,
  kGainsALittle,
  kFailsInSilence,
  kThrows,
  kNeverEnds,
  kCrashes,
  kClaimsErrorControl,
  kClaimsToBeExplicit,
  kClaimsToBeLStable,  ///< Is the implicit midpoint rule, registered as backward Euler.
  kFallsUpward,
  kForgetsToSplit,  ///< An additive method that treats contact implicitly.
  kDrags            ///< One per cent of the velocity per step.
};

template <Defect kDefect>
class FaultyStepper final : public dynamics::Stepper {
 public:
  FaultyStepper(dynamics::System& system, dynamics::State& state, const IntegratorSpec& spec)
      : state_(state) {
    IntegratorSpec inner = spec;
    if constexpr (kDefect == Defect::kForgetsToSplit)
      inner.explicit_side = IntegratorSpec{}.explicit_side, inner.fixed_step = true;
    else
      inner.name = kDefect == Defect::kClaimsToBeLStable ? "implicit-midpoint" : "linearly-implicit-euler";
    inner_ = integrate::make_stepper(system, state, inner);
  }
  std::string name() const override { return "faulty"; }
  dynamics::StepResult advance_to(double t_end) override {
    if constexpr (kDefect == Defect::kThrows) throw std::logic_error("thrown on purpose");
    if constexpr (kDefect == Defect::kCrashes) std::abort();
    if constexpr (kDefect == Defect::kNeverEnds)
      for (volatile double busy = 1.0; !interrupted();) busy = busy * 1.0000001;
    dynamics::StepResult result = inner_->advance_to(t_end);
    if constexpr (kDefect == Defect::kNeverEnds) result.status = dynamics::StepStatus::kInterrupted;
    if constexpr (kDefect == Defect::kNotANumber)
      if (state_.layout().u_size > 0) state_.u()[0] = std::numeric_limits<double>::quiet_NaN();
    if constexpr (kDefect == Defect::kGainsEnergy) state_.u() *= 3.0, state_.q() *= kGainOfPositions;
    if constexpr (kDefect == Defect::kGainsALittle) state_.u() *= 1.05;
    if constexpr (kDefect == Defect::kDrags) state_.u() *= 0.99;
    if constexpr (kDefect == Defect::kFallsUpward) state_.q().array() += 1.0;
    if constexpr (kDefect == Defect::kFailsInSilence) result.status = dynamics::StepStatus::kNewtonFailed;
    return result;
  }
  bool dense_output(double, VecX&, VecX&) const override { return false; }
  void reinit(dynamics::ReinitReason reason) override { inner_->reinit(reason); }
  const dynamics::StepperCounters& counters() const override { return inner_->counters(); }

 private:
  static constexpr double kGainOfPositions = 3.0;
  dynamics::State& state_;
  std::unique_ptr<dynamics::Stepper> inner_;
};

template <Defect kDefect>
const dynamics::StepperRegistry& registry_of() {
  using dynamics::StepControl;
  static const dynamics::StepperRegistry registry = [] {
    const char* name = kDefect == Defect::kClaimsToBeExplicit  ? "symplectic-euler"
                       : kDefect == Defect::kClaimsToBeLStable ? "backward-euler"
                       : kDefect == Defect::kForgetsToSplit    ? "ark-imex-3"
                                                               : "linearly-implicit-euler";
    // The expectation is that for the method itself.
    dynamics::StepperEntry entry = find(integrate::stepper_registry(), name, "integrator");
    entry.summary = "broken on purpose";
    if (kDefect == Defect::kClaimsErrorControl) entry.traits.control = StepControl::kAdaptive;
    if (kDefect == Defect::kForgetsToSplit) entry.traits.control = StepControl::kFixed;
    entry.make = [](dynamics::System& system, dynamics::State& state, const IntegratorSpec& spec,
                    std::unique_ptr<dynamics::LinearSolver>) -> std::unique_ptr<dynamics::Stepper> {
      return std::make_unique<FaultyStepper<kDefect>>(system, state, spec);
    };
    return dynamics::StepperRegistry{entry};
  }();
  return registry;
}

/// Registry with this defect, for StabilityOptions::registry.
using Registry = const dynamics::StepperRegistry& (*)();
inline Registry registry(Defect defect) {
  switch (defect) {
    case Defect::kNothing: return registry_of<Defect::kNothing>;
    case Defect::kNotANumber: return registry_of<Defect::kNotANumber>;
    case Defect::kGainsEnergy: return registry_of<Defect::kGainsEnergy>;
    case Defect::kGainsALittle: return registry_of<Defect::kGainsALittle>;
    case Defect::kFailsInSilence: return registry_of<Defect::kFailsInSilence>;
    case Defect::kThrows: return registry_of<Defect::kThrows>;
    case Defect::kNeverEnds: return registry_of<Defect::kNeverEnds>;
    case Defect::kCrashes: return registry_of<Defect::kCrashes>;
    case Defect::kClaimsErrorControl: return registry_of<Defect::kClaimsErrorControl>;
    case Defect::kClaimsToBeExplicit: return registry_of<Defect::kClaimsToBeExplicit>;
    case Defect::kClaimsToBeLStable: return registry_of<Defect::kClaimsToBeLStable>;
    case Defect::kFallsUpward: return registry_of<Defect::kFallsUpward>;
    case Defect::kForgetsToSplit: return registry_of<Defect::kForgetsToSplit>;
    case Defect::kDrags: return registry_of<Defect::kDrags>;
  }
  fail("no such fault");
}

}  // namespace palpate::faulty
