#include "core/finite.h"
#include "integrate/fixed_step/fixed_step.h"
#include "integrate/fixed_step/linearized_step.h"
#include "integrate/make.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

/// Step of Baraff and Witkin (1998), as in Galoppo et al. (2007): M (u1 - u0) = h f(q1, u1), q1 = q0 + h N
/// u1, with the force linearized about (q0, u0) at the time t1 = t0 + h of the implicit rule, f1 = f - K h u1
/// - D (u1 - u0):
///     free directions:  (M + h D + h^2 K) du = h (f - h K u0)
/// Driven directions move to x(t1), v(t1) exactly. Their displacement dx and velocity change dv enter the
/// free rows unchanged,
///     (M + h D + h^2 K) du = h (f - K s - D dv) - M dv,
///     s = h u0 on free directions, dx on driven ones;   dv = 0 on free ones,
/// so no force acts in a body that moves rigidly with its drive. Order 1; L-stable on linear problems with M,
/// D, K positive. A value that is not finite is returned as a status.
/// Dense output is linear within the last step, which has the order of the method.
class LinearlyImplicitEuler final : public FixedStep {
 public:
  LinearlyImplicitEuler(System& system, State& state, const IntegratorSpec& spec,
                        std::unique_ptr<LinearSolver> solver)
      : FixedStep("linearly-implicit-euler", 1, Between::kLinear, system, state, spec),
        equations_(system, std::move(solver), spec) {}

 private:
  /// Computes s and dv of the derivation above. A direction carried by a master moves with the master's
  /// explicit prediction.
  void predict_drives(double t1, double h) {
    shift_ = h * state_.u();
    if (drives_speed_up_ || change_.size() != layout().u_size) change_.setZero(layout().u_size);
    drives_speed_up_ = false;
    if (!system_.any_driven()) return;
    if (layout().border_size() > 0) {  // Masters; without a master the imposed values depend on time alone.
      q_dot(layout(), state_.q().data(), state_.u().data(), q1_.data());
      q1_ = state_.q() + h * q1_;
      u1_ = state_.u();
    }
    system_.impose(layout(), t1, q1_.data(), u1_.data());
    for (int dof : system_.driven_dofs()) {
      shift_[dof] = q1_[dof] - state_.q()[dof];
      change_[dof] = u1_[dof] - state_.u()[dof];
      drives_speed_up_ = drives_speed_up_ || change_[dof] != 0.0;  // Always false for fixed nodes.
    }
  }

  /// Computes the state after a velocity change du; without a border, in one pass over the vectors.
  void move(double h) {
    if (layout().border_size() == 0) {
      const auto q = state_.q(), u = state_.u();
      for (Eigen::Index i = 0; i < du_.size(); ++i) {
        u1_[i] = u[i] + du_[i];
        q1_[i] = q[i] + h * u1_[i];
      }
      return;
    }
    u1_ = state_.u() + du_;
    q_dot(layout(), state_.q().data(), u1_.data(), q1_.data());
    q1_ = state_.q() + h * q1_;
    project(layout(), q1_.data());
  }

  Attempt attempt(double h, double t1) override {
    predict_drives(t1, h);
    const StateView at = state_.view(t1, state_.q().data(), state_.u().data());
    const StepStatus status = equations_.solve({at, h, shift_, change_, !drives_speed_up_}, du_, counters_);
    if (status == StepStatus::kNotFinite) return {.status = status, .what = "the force is not finite"};
    if (status != StepStatus::kOk)
      return {.status = status, .what = "the step matrix is singular or not finite"};
    if (!all_finite(du_)) return {.status = StepStatus::kNotFinite, .what = "the velocity is not finite"};
    move(h);
    system_.impose(layout(), t1, q1_.data(), u1_.data());
    return {.iterations = 1};
  }
  void forget(ReinitReason) override { equations_.forget(); }
  void collect(StepperCounters& counters) const override { equations_.report(counters); }

  LinearizedStep equations_;
  VecX shift_, change_, du_;
  bool drives_speed_up_ = false;  ///< change_ is not zero.
};

}  // namespace

std::unique_ptr<Stepper> make_linearly_implicit_euler(System& system, State& state,
                                                      const IntegratorSpec& spec,
                                                      std::unique_ptr<LinearSolver> solver) {
  return std::make_unique<LinearlyImplicitEuler>(system, state, spec, std::move(solver));
}

}  // namespace palpate::integrate
