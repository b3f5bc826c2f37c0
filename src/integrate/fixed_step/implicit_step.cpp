#include "integrate/fixed_step/implicit_step.h"

#include "integrate/settings.h"

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

bool ImplicitStep::start_acceleration(VecX& a) {
  const dynamics::StateView at = now();
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
