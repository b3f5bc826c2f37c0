#pragma once
#include "integrate/fixed_step/fixed_step.h"
#include "integrate/fixed_step/stage_newton.h"

namespace palpate::integrate {

/// A hand-written method whose steps are implicit stages: a FixedStep with a StageNewton and the last
/// accepted acceleration as its first guess.
class ImplicitStep : public FixedStep {
 protected:
  ImplicitStep(std::string name, int order, Between between, dynamics::System& system, dynamics::State& state,
               const IntegratorSpec& spec, std::unique_ptr<dynamics::LinearSolver> solver);

  /// Solves stage_ from the State; its end goes to q1_ and u1_, its unknown to a_.  Adds to what a stage
  /// before it in the same step took.
  Attempt solve_stage(const Attempt& before = {});
  /// Whether friction sticks somewhere at the State.
  bool sticks();
  /// u' at the State without its driven entries (no stage reads them); false where it is not finite.  Where
  /// friction sticks, that which a backward Euler step of length h to t1 has at its end.
  bool start_acceleration(double h, double t1, VecX& a);
  /// Sets a_ to the guess of a step's first stage.
  void guess();

  void accepted(double h) override;
  void forget(dynamics::ReinitReason reason) override;
  void collect(dynamics::StepperCounters& counters) const override;

  Stage stage_;
  VecX a_;  ///< of the stage solved last

 private:
  StageNewton newton_;
  VecX accepted_a_;
};

}  // namespace palpate::integrate
