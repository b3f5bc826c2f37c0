// Steps a soft body by a custom integrator: velocity Verlet, explicit, symplectic, of order 2. An elastic bar
// is stretched and released; halving the step divides the error by 2^2.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/generators.h"

using namespace palpate;

/// u_1/2 = u0 + h/2 a(q0),  q1 = q0 + h u_1/2,  u1 = u_1/2 + h/2 a(q1).  Valid for nodes (q' = u) under
/// forces that do not depend on velocity; stable for h below 2 / w_max.
class VelocityVerlet : public dynamics::Stepper {
 public:
  VelocityVerlet(dynamics::System& system, dynamics::State& state, double step)
      : system_(system), state_(state), step_(step) {}
  std::string name() const override { return "velocity-verlet"; }

  /// Takes equal steps that are no longer than the given one, and ends exactly at t_end.
  dynamics::StepResult advance_to(double t_end) override {
    const double start = state_.time();
    if (t_end <= start) return result(dynamics::StepStatus::kOk, start, 0.0);
    const long steps = std::max(1L, std::lround(std::ceil((t_end - start) / step_ - 1e-9)));
    const double h = (t_end - start) / static_cast<double>(steps);
    for (long i = 1; i <= steps; ++i) {
      if (interrupted()) return result(dynamics::StepStatus::kInterrupted, state_.time(), h);
      t0_ = state_.time(), q0_ = state_.q(), u0_ = state_.u();
      if (!a1_is_current_) evaluate(a1_);
      a0_ = a1_;
      state_.u() += 0.5 * h * a0_;
      state_.q() += h * state_.u();
      state_.set_time(i == steps ? t_end : start + static_cast<double>(i) * h);
      evaluate(a1_);
      state_.u() += 0.5 * h * a1_;
      // Held and driven directions have given values.
      system_.impose(state_.layout(), state_.time(), state_.q().data(), state_.u().data());
      a1_is_current_ = a1_.allFinite();
      if (!a1_is_current_) {  // a failure leaves the last good step in the state
        state_.set_time(t0_), state_.q() = q0_, state_.u() = u0_;
        return result(dynamics::StepStatus::kNotFinite, t0_, h);
      }
      ++counters_.steps;
    }
    return result(dynamics::StepStatus::kOk, t_end, h);
  }

  /// Interpolates within the last step, with acceleration linear in time for u.
  bool dense_output(double t, VecX& q, VecX& u) const override {
    const double h = state_.time() - t0_, s = t - t0_;
    if (q0_.size() == 0 || s < 0.0 || s > h) return false;
    q = q0_ + s * u0_ + 0.5 * s * s * a0_;
    u = u0_ + s * a0_ + 0.5 * s * s / h * (a1_ - a0_);
    return true;
  }
  /// Forgets the acceleration of the last step: a force or the state has changed.
  void reinit(dynamics::ReinitReason) override { a1_is_current_ = false, ++counters_.reinits; }
  const dynamics::StepperCounters& counters() const override { return counters_; }

 private:
  static dynamics::StepResult result(dynamics::StepStatus status, double t, double h) {
    dynamics::StepResult out;
    out.status = status, out.t = t, out.h = h, out.order = 2;
    return out;
  }
  void evaluate(VecX& a) { system_.acceleration(state_.view(), a), ++counters_.force_evaluations; }
  dynamics::System& system_;
  dynamics::State& state_;
  double step_, t0_ = 0.0;  ///< [s]
  VecX q0_, u0_, a0_, a1_;  ///< At the start of the last step; acceleration at its end.
  bool a1_is_current_ = false;
  dynamics::StepperCounters counters_;
};

/// Returns the positions after t seconds, by Verlet steps or, where `step` is 0, by a tight tolerance.
VecX positions_after(double t, double step) {
  const TetMesh mesh = mesh::box({0.02, 0.02, 0.1}, {2, 2, 10});
  const fem::Material rubber{.youngs_modulus = 1e4};
  const VecX rest = mesh.nodes.reshaped(), stretched = 1.05 * rest;
  const int n = static_cast<int>(rest.size());
  dynamics::State state;
  const int bar = state.insert({.name = "bar", .q_size = n, .u_size = n}, stretched, VecX::Zero(n));
  dynamics::System system;
  system.add(std::make_shared<fem::SoftBody>("bar", mesh, rubber, fem::SoftBodyOptions{}, bar));
  system.add(fem::make_lumped_mass(mesh, rubber.density, bar));
  system.prepare(state.view());
  std::unique_ptr<dynamics::Stepper> stepper = std::make_unique<VelocityVerlet>(system, state, step);
  if (step == 0.0) stepper = integrate::make_stepper(system, state, {.name = "cvode-adams", .rtol = 1e-10});
  const dynamics::StepResult result = stepper->advance_to(t);
  if (!result.ok()) std::printf("%s: %s\n", stepper->name().c_str(), to_string(result.status));
  return state.q();
}

int main() {
  const double t = 0.1, h = 1e-4;  // [s]
  const VecX exact = positions_after(t, 0.0);
  const double coarse = (positions_after(t, h) - exact).norm(),
               fine = (positions_after(t, h / 2) - exact).norm();
  std::printf("ok: error %.3g m at %g s, %.3g m at half the step: order %.3f, by theory 2\n", coarse, h, fine,
              std::log2(coarse / fine));
}
