#pragma once
#include "palpate/integrate/integrators.h"

/// Two steppers that do no work. Each replaces every method of the registry, with the traits of that method,
/// so that all expectations of theory are applied to it.
namespace palpate::lazy {

enum class Laziness {
  kOnlyTheClock,  ///< Advances the time, leaves the state unchanged, and reports success.
  kRefuses        ///< Ends every step with an error and a message.
};

template <Laziness kLaziness>
class LazyStepper final : public dynamics::Stepper {
 public:
  explicit LazyStepper(dynamics::State& state) : state_(state) {}
  std::string name() const override { return "lazy"; }
  dynamics::StepResult advance_to(double t_end) override {
    dynamics::StepResult result;
    if constexpr (kLaziness == Laziness::kOnlyTheClock) {
      state_.set_time(t_end);
      ++counters_.steps;
    } else {
      result.status = dynamics::StepStatus::kNewtonFailed;
      result.message = "refused on purpose";
    }
    result.t = state_.time();
    return result;
  }
  bool dense_output(double, VecX&, VecX&) const override { return false; }
  void reinit(dynamics::ReinitReason) override { ++counters_.reinits; }
  const dynamics::StepperCounters& counters() const override { return counters_; }

 private:
  dynamics::State& state_;
  dynamics::StepperCounters counters_;
};

template <Laziness kLaziness>
const dynamics::StepperRegistry& registry() {
  static const dynamics::StepperRegistry all = [] {
    dynamics::StepperRegistry made = integrate::stepper_registry();
    for (dynamics::StepperEntry& entry : made)
      entry.make = [](dynamics::System&, dynamics::State& state, const IntegratorSpec&,
                      std::unique_ptr<dynamics::LinearSolver>) -> std::unique_ptr<dynamics::Stepper> {
        return std::make_unique<LazyStepper<kLaziness>>(state);
      };
    return made;
  }();
  return all;
}

}  // namespace palpate::lazy
