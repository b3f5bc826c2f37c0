#include "integrate/fixed_step/displace.h"
#include "integrate/fixed_step/fixed_step.h"
#include "integrate/make.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

/// Symplectic Euler, velocity first:
///     u1 = u0 + h M^-1 f(q0, u0, t0),     q1 = q0 (+) h u1.
/// One force per step and no tangent: f(q1, u1, t1) is evaluated at the end of the step, so that no state
/// without a finite force is accepted, and used by the next step.
///
/// Order 1; symplectic on separable systems, so an undamped energy oscillates by O(h) and does not drift.
/// Stability: a mode q'' + 2 z w q' + w^2 q = 0 is advanced by
///     [q; u] <- [1 - W^2, h (1 - 2 z W); -w^2 h, 1 - 2 z W] [q; u],     W = w h:
/// trace 2 - W^2 - 2 z W, determinant 1 - 2 z W, both roots inside the unit circle while W < 2 (sqrt(1 + z^2)
/// - z): undamped 2/w. Damping is evaluated at the old velocity and therefore reduces the stable step.
/// Stiff order 0: a mode that the step does not resolve grows until the force is not finite, which ends the
/// run.
class SymplecticEuler final : public FixedStep {
 public:
  SymplecticEuler(System& system, State& state, const IntegratorSpec& spec)
      : FixedStep("symplectic-euler", 1, Between::kLinear, system, state, spec) {}

 private:
  Attempt attempt(double h, double t1) override {
    const Attempt not_finite{.status = StepStatus::kNotFinite, .what = kBlowUp};
    const StateView from = now();
    if (start_a_.size() != layout().u_size &&
        !acceleration(from.time, from.q.data(), from.u.data(), start_a_))
      return start_a_.resize(0), not_finite;
    u1_ = from.u + h * start_a_;
    theta_ = h * u1_;
    if (!displace(layout(), from.q.data(), theta_.data(), q1_.data(), scratch_)) return not_finite;
    project(layout(), q1_.data());
    system_.impose(layout(), t1, q1_.data(), u1_.data());
    if (!acceleration(t1, q1_.data(), u1_.data(), end_a_)) return not_finite;
    return {};
  }
  void accepted(double) override { start_a_.swap(end_a_); }
  void forget(ReinitReason) override { start_a_.resize(0); }

  static constexpr const char* kBlowUp =
      "the force or the velocity is not finite; step_s of an explicit method must be below its stability "
      "limit";
  VecX start_a_, end_a_, theta_, scratch_;
};

}  // namespace

std::unique_ptr<Stepper> make_symplectic_euler(System& system, State& state, const IntegratorSpec& spec,
                                               std::unique_ptr<LinearSolver>) {
  return std::make_unique<SymplecticEuler>(system, state, spec);
}

}  // namespace palpate::integrate
