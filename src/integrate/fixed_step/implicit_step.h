#pragma once
#include "integrate/fixed_step/fixed_step.h"
#include "integrate/fixed_step/stage_newton.h"

namespace palpate::integrate {

/// Hand-written method whose steps are implicit stages: a FixedStep with a StageNewton, whose initial guess
/// is the last accepted acceleration.
class ImplicitStep : public FixedStep {
 protected:
  ImplicitStep(std::string name, int order, Between between, dynamics::System& system, dynamics::State& state,
               const IntegratorSpec& spec, std::unique_ptr<dynamics::LinearSolver> solver);

  /// Solves stage_ from the State; its end is written to q1_ and u1_, its unknown to a_. `before` is the
  /// result of an earlier stage of the same step, whose iterations are added.
  Attempt solve_stage(const Attempt& before = {});
  /// Returns whether friction sticks at some contact of the State.
  bool sticks();
  /// Computes u' at the State without its driven entries (no stage reads them); returns false where it is not
  /// finite. Where friction sticks, it is the acceleration at the end of a backward Euler step of length h to
  /// t1.
  bool start_acceleration(double h, double t1, VecX& a);
  /// Sets a_ to the initial guess of the first stage of a step.
  void guess();

  void accepted(double h) override;
  void forget(dynamics::ReinitReason reason) override;
  void collect(dynamics::StepperCounters& counters) const override;

  Stage stage_;
  VecX a_;  ///< Unknown of the stage solved last.

 private:
  StageNewton newton_;
  VecX accepted_a_;
};

}  // namespace palpate::integrate
