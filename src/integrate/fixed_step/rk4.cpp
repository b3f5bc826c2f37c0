#include "core/finite.h"
#include "integrate/fixed_step/fixed_step.h"
#include "integrate/make.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

/// The classical Runge-Kutta method (Kutta 1901) on y = [q; u], y' = F(t, y) = [N(q) u; M^-1 f]:
///     k1 = F(t0, y0),               k2 = F(t0 + h/2, y0 + h/2 k1),
///     k3 = F(t0 + h/2, y0 + h/2 k2),  k4 = F(t1, y0 + h k3),
///     y1 = y0 + h/6 (k1 + 2 k2 + 2 k3 + k4).
/// Driven directions have their exact values in every stage.  Four force evaluations per step and no tangent:
/// k1 is taken at the end of the step before, so that no state is accepted that has no finite force.
///
/// Order 4.  Stability: R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24, |R| <= 1 up to 2.828 on the imaginary axis
/// (undamped modes: h < 2.828/w) and 2.785 on the negative real one.  Stiff order 0: a mode outside grows
/// until the force is not finite, which ends the run.
class RungeKutta4 final : public FixedStep {
 public:
  RungeKutta4(System& system, State& state, const IntegratorSpec& spec)
      : FixedStep("rk4", 4, Between::kCubicWithAcceleration, system, state, spec) {}

 private:
  Attempt attempt(double h, double t1) override {
    const Attempt not_finite{.status = StepStatus::kNotFinite, .what = kBlowUp};
    const StateView from = now();
    if (start_a_.size() != layout().u_size &&
        !acceleration(from.time, from.q.data(), from.u.data(), start_a_))
      return start_a_.resize(0), not_finite;
    const double middle = from.time + 0.5 * h;
    rate_.resize(layout().q_size);
    q_dot(layout(), from.q.data(), from.u.data(), rate_.data());
    a_ = start_a_;
    q_sum_ = rate_;
    u_sum_ = a_;
    if (!stage(0.5 * h, middle, 2.0) || !stage(0.5 * h, middle, 2.0) || !stage(h, t1, 1.0)) return not_finite;
    q1_ = from.q + h / 6.0 * q_sum_;
    u1_ = from.u + h / 6.0 * u_sum_;
    if (!all_finite(q1_) || !all_finite(u1_)) return not_finite;
    project(layout(), q1_.data());
    system_.impose(layout(), t1, q1_.data(), u1_.data());
    if (!acceleration(t1, q1_.data(), u1_.data(), end_a_)) return not_finite;
    return {};
  }

  /// Computes the next k, at the State plus `step` times the last one, and adds it to the sums with its
  /// weight.
  bool stage(double step, double t, double weight) {
    q1_ = state_.q() + step * rate_;
    u1_ = state_.u() + step * a_;
    system_.impose(layout(), t, q1_.data(), u1_.data());
    if (!all_finite(q1_) || !all_finite(u1_) || !acceleration(t, q1_.data(), u1_.data(), a_)) return false;
    q_dot(layout(), q1_.data(), u1_.data(), rate_.data());
    q_sum_ += weight * rate_;
    u_sum_ += weight * a_;
    return true;
  }

  void accepted(double) override {
    a0_.swap(start_a_);
    a1_ = end_a_;
    start_a_ = end_a_;
  }
  void forget(ReinitReason) override { start_a_.resize(0); }

  static constexpr const char* kBlowUp =
      "the force or the velocity is not finite; step_s of an explicit method must be below its stability "
      "limit";
  VecX start_a_, end_a_, a_, rate_, q_sum_, u_sum_;
};

}  // namespace

std::unique_ptr<Stepper> make_rk4(System& system, State& state, const IntegratorSpec& spec,
                                  std::unique_ptr<LinearSolver>) {
  return std::make_unique<RungeKutta4>(system, state, spec);
}

}  // namespace palpate::integrate
