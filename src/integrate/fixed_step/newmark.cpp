#include "integrate/fixed_step/implicit_step.h"
#include "integrate/make.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

/// Newmark (1959) with beta = 1/4, gamma = 1/2, the average acceleration method:
///     M(q1) a1 = f(q1, u1, t1),     u1 = u0 + h (a0 + a1)/2,
///     q1 = q0 (+) [h u0 + h^2 (a0 + a1)/4] = q0 (+) h (u0 + u1)/2.
/// A Stage in the unknown a1 with u1 = (u0 + h/2 a0) + h/2 a1, theta = (h u0 + h^2/4 a0) + h^2/4 a1 and the
/// matrix M + h/2 D + h^2/4 K. a0 is a1 of the last step; at a start and after a re-initialisation it is M^-1
/// f(q0, u0, t0), or where friction sticks the acceleration of a backward Euler step
/// (ImplicitStep::start_acceleration).
///
/// Order 2; on y' = f(y) it is the trapezoidal rule. With a0 = M^-1 f0 a linear mode is advanced as by the
/// implicit midpoint rule, so its energy is conserved. On a non-linear system it is the trapezoidal rule,
/// which is conjugate to the midpoint rule: the energy error is bounded but not zero.
/// Stability: A-stable, R(infinity) = -1 (spectral radius 1, no numerical damping).
/// a is an independent variable: its rounding causes an error in q of (w h)^2 machine roundings, which the
/// other methods here do not have. Stiff order 2: the trapezoidal rule is collocation of stage order 2, e1 =
/// R e0 + O(h^3)/(1 + l h/2); a deviation at the start alternates, undamped.
class Newmark final : public ImplicitStep {
 public:
  Newmark(System& system, State& state, const IntegratorSpec& spec, std::unique_ptr<LinearSolver> solver)
      : ImplicitStep("newmark", 2, Between::kCubic, system, state, spec, std::move(solver)) {}

 private:
  Attempt attempt(double h, double t1) override {
    if (start_a_.size() != layout().u_size && !start_acceleration(h, t1, start_a_)) {
      start_a_.resize(0);
      return {.status = StepStatus::kNotFinite, .what = "the force is not finite"};
    }
    stage_.t1 = t1;
    stage_.c_u = 0.5 * h;
    stage_.c_theta = 0.25 * h * h;
    stage_.u = state_.u() + 0.5 * h * start_a_;
    stage_.theta = h * state_.u() + 0.25 * h * h * start_a_;
    a_ = start_a_;
    return solve_stage();
  }
  void accepted(double h) override {
    ImplicitStep::accepted(h);
    start_a_ = a_;
  }
  void forget(ReinitReason reason) override {
    ImplicitStep::forget(reason);
    start_a_.resize(0);
  }

  VecX start_a_;  ///< a0.
};

}  // namespace

std::unique_ptr<Stepper> make_newmark(System& system, State& state, const IntegratorSpec& spec,
                                      std::unique_ptr<LinearSolver> solver) {
  return std::make_unique<Newmark>(system, state, spec, std::move(solver));
}

}  // namespace palpate::integrate
