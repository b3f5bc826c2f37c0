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

/// Linearly implicit Euler, broken on purpose in one way: what the stability matrix must find.
namespace palpate::spoilt {

enum class Spoil {
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
  kFallsUpward
};

template <Spoil kSpoil>
class SpoiltStepper final : public dynamics::Stepper {
 public:
  SpoiltStepper(dynamics::System& system, dynamics::State& state, const IntegratorSpec& spec)
      : state_(state) {
    IntegratorSpec inner = spec;
    inner.name = "linearly-implicit-euler";
    inner_ = integrate::make_stepper(system, state, inner);
  }
  std::string name() const override { return "spoilt"; }
  dynamics::StepResult advance_to(double t_end) override {
    if constexpr (kSpoil == Spoil::kThrows) throw std::logic_error("thrown on purpose");
    if constexpr (kSpoil == Spoil::kCrashes) std::abort();
    if constexpr (kSpoil == Spoil::kNeverEnds)
      for (volatile double busy = 1.0; !interrupted();) busy = busy * 1.0000001;
    dynamics::StepResult result = inner_->advance_to(t_end);
    if constexpr (kSpoil == Spoil::kNeverEnds) result.status = dynamics::StepStatus::kInterrupted;
    if constexpr (kSpoil == Spoil::kNotANumber)
      if (state_.layout().u_size > 0) state_.u()[0] = std::numeric_limits<double>::quiet_NaN();
    if constexpr (kSpoil == Spoil::kGainsEnergy) state_.u() *= 3.0, state_.q() *= kGainOfPositions;
    if constexpr (kSpoil == Spoil::kGainsALittle) state_.u() *= 1.05;
    if constexpr (kSpoil == Spoil::kFallsUpward) state_.q().array() += 1.0;
    if constexpr (kSpoil == Spoil::kFailsInSilence) result.status = dynamics::StepStatus::kNewtonFailed;
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

template <Spoil kSpoil>
const dynamics::StepperRegistry& registry_of() {
  using dynamics::Stability;
  using dynamics::StepControl;
  static const dynamics::StepperRegistry registry = {
      {"spoilt",
       "broken on purpose",
       {"Euler", 1, 1, kSpoil == Spoil::kClaimsErrorControl ? StepControl::kAdaptive : StepControl::kFixed,
        kSpoil == Spoil::kClaimsToBeExplicit ? Stability::kExplicit : Stability::kL, true, false,
        "force, tangent"},
       [](dynamics::System& system, dynamics::State& state, const IntegratorSpec& spec,
          std::unique_ptr<dynamics::LinearSolver>) -> std::unique_ptr<dynamics::Stepper> {
         return std::make_unique<SpoiltStepper<kSpoil>>(system, state, spec);
       }}};
  return registry;
}

/// Makes the registry with this fault: StabilityOptions::registry.
using Registry = const dynamics::StepperRegistry& (*)();
inline Registry registry(Spoil spoil) {
  switch (spoil) {
    case Spoil::kNothing: return registry_of<Spoil::kNothing>;
    case Spoil::kNotANumber: return registry_of<Spoil::kNotANumber>;
    case Spoil::kGainsEnergy: return registry_of<Spoil::kGainsEnergy>;
    case Spoil::kGainsALittle: return registry_of<Spoil::kGainsALittle>;
    case Spoil::kFailsInSilence: return registry_of<Spoil::kFailsInSilence>;
    case Spoil::kThrows: return registry_of<Spoil::kThrows>;
    case Spoil::kNeverEnds: return registry_of<Spoil::kNeverEnds>;
    case Spoil::kCrashes: return registry_of<Spoil::kCrashes>;
    case Spoil::kClaimsErrorControl: return registry_of<Spoil::kClaimsErrorControl>;
    case Spoil::kClaimsToBeExplicit: return registry_of<Spoil::kClaimsToBeExplicit>;
    case Spoil::kFallsUpward: return registry_of<Spoil::kFallsUpward>;
  }
  fail("no such fault");
}

}  // namespace palpate::spoilt
