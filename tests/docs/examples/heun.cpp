#include "integrate/fixed_step/displace.h"
#include "integrate/fixed_step/fixed_step.h"
#include "integrate/make.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

/// Heun's method, explicit, of order 2:
///     u* = u0 + h a(q0, u0, t0),   q* = q0 (+) h u0,   a1 = a(q*, u*, t1),
///     u1 = u0 + h (a0 + a1)/2,     q1 = q0 (+) h (u0 + u*)/2.
class Heun final : public FixedStep {
 public:
  Heun(System& system, State& state, const IntegratorSpec& spec)
      : FixedStep("heun", 2, Between::kCubic, system, state, spec) {}

 private:
  Attempt attempt(double h, double t1) override {
    const Attempt not_finite{.status = StepStatus::kNotFinite, .what = "the force is not finite"};
    const StateView from = now();
    if (!acceleration(from.time, from.q.data(), from.u.data(), start_)) return not_finite;
    u1_ = from.u + h * start_;
    if (!move(from, h * from.u, t1)) return not_finite;
    if (!acceleration(t1, q1_.data(), u1_.data(), end_)) return not_finite;
    const VecX shift = 0.5 * h * (from.u + u1_);
    u1_ = from.u + 0.5 * h * (start_ + end_);
    return move(from, shift, t1) ? Attempt{} : not_finite;
  }
  void forget(ReinitReason) override {}

  /// q1 = q0 (+) shift; prescribed directions take their values at t1.
  bool move(const StateView& from, const VecX& shift, double t1) {
    if (!displace(layout(), from.q.data(), shift.data(), q1_.data(), scratch_)) return false;
    project(layout(), q1_.data());
    system_.impose(layout(), t1, q1_.data(), u1_.data());
    return true;
  }
  VecX start_, end_, scratch_;
};

}  // namespace

std::unique_ptr<Stepper> make_heun(System& system, State& state, const IntegratorSpec& spec,
                                   std::unique_ptr<LinearSolver>) {
  return std::make_unique<Heun>(system, state, spec);
}

}  // namespace palpate::integrate
