#include "integrate/fixed_step/implicit_step.h"

#include <algorithm>

#include "integrate/settings.h"
#include "integrate/tuning.h"
#include "palpate/dynamics/repeated_step.h"

namespace palpate::integrate {

ImplicitStep::ImplicitStep(std::string name, int order, Between between, dynamics::System& system,
                           dynamics::State& state, const IntegratorSpec& spec,
                           std::unique_ptr<dynamics::LinearSolver> solver)
    : FixedStep(std::move(name), order, between, system, state, spec),
      newton_(system, spec, std::move(solver)) {
  check_newton(spec_);
}

ImplicitStep::Attempt ImplicitStep::solve_stage(const Attempt& before) {
  if (before.status != dynamics::StepStatus::kOk) return before;
  const NewtonResult newton = newton_.solve(stage_, now(), a_, q1_, u1_, counters_);
  return {newton.status, before.iterations + newton.iterations, newton.correction, newton.what, true};
}

bool ImplicitStep::sticks() {
  const auto& terms = system_.terms();
  const dynamics::StateView at = now();
  return std::any_of(terms.begin(), terms.end(), [&](const auto& term) {
    auto* const repeated = dynamic_cast<dynamics::RepeatedStepTerm*>(term.get());
    return repeated && repeated->has_onset_at(at);
  });
}

// At rest friction is zero by its law, and the acceleration there is the one without friction. Friction
// reaches mu N within the time v_r/(mu g), which no step resolves, and methods that use the acceleration at
// the start (the trapezoidal rule: half of it over h) would add h mu g/2 to the velocity permanently.
// Backward Euler damps this layer; the acceleration at the end of its step is within the cone, and elsewhere
// has an error of O(h), in one step only. This step need not have the full length: where Newton's method
// fails it is halved, as steps are.
bool ImplicitStep::start_acceleration(double h, double t1, VecX& a) {
  const dynamics::StateView at = now();
  if (sticks()) {
    Stage euler;
    euler.u = state_.u();
    for (int halvings = 0; halvings <= tuning::kHalvings; ++halvings, h /= 2.0) {
      euler.t1 = halvings == 0 ? t1 : at.time + h;
      euler.c_u = h;
      euler.c_theta = h * h;
      euler.theta = h * state_.u();
      a.setZero(layout().u_size);
      if (newton_.solve(euler, at, a, q1_, u1_, counters_).status == dynamics::StepStatus::kOk) return true;
    }
  }
  if (!acceleration(at.time, at.q.data(), at.u.data(), a)) return false;
  for (int dof : system_.driven_dofs()) a[dof] = 0.0;
  return true;
}

void ImplicitStep::guess() {
  if (accepted_a_.size() == layout().u_size)
    a_ = accepted_a_;
  else
    a_.setZero(layout().u_size);
}

void ImplicitStep::accepted(double) {
  accepted_a_ = a_;
  newton_.step_done();
}

void ImplicitStep::forget(dynamics::ReinitReason) {
  accepted_a_.resize(0);
  newton_.forget();
}

void ImplicitStep::collect(dynamics::StepperCounters& counters) const { newton_.solver().report(counters); }

}  // namespace palpate::integrate
