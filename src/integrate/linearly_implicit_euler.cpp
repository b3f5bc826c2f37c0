#include <cmath>

#include "integrate/make.h"
#include "integrate/settings.h"
#include "integrate/step_solver.h"
#include "palpate/core/clock.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

/// Baraff and Witkin (1998), the step of Galoppo et al. (2007).  M (u1 - u0) = h f(q1, u1), q1 = q0 + h N u1, with the
/// force made linear about (q0, u0) at the time t1 = t0 + h of the implicit rule, f1 = f - K h u1 - D (u1 - u0):
///     free directions:  (M + h D + h^2 K) du = h (f - h K u0)
/// Driven directions go to x(t1), v(t1) exactly.  Their displacement dx and velocity change dv enter the free rows as what they are,
///     (M + h D + h^2 K) du = h (f - K s - D dv) - M dv,   s = h u0 on free directions, dx on driven ones;  dv = 0 on free ones,
/// so a body that moves rigidly with its drive feels no force.  Order 1; L-stable on linear problems with M, D, K positive.
/// A value that is not finite ends the step as data; an indefinite matrix is met as StepSolver says: the right-hand side keeps the
/// true K, so that a projected matrix changes du by h^2 (K_p - K) du, which is O(h^3).
/// Dense output is linear within the last step, which has the method's order.
class LinearlyImplicitEuler final : public Stepper {
 public:
  LinearlyImplicitEuler(System& system, State& state, const IntegratorSpec& spec, std::unique_ptr<LinearSolver> solver)
      : system_(system), state_(state), spec_(spec), solver_(std::move(solver), spec) {
    check_fixed_step(spec_);
    counters::count("integrate.linearly-implicit-euler");
  }

  std::string name() const override { return "linearly-implicit-euler"; }

  StepResult advance_to(double t_end) override {
    PALPATE_CHECK(t_end > state_.time(), "t_end = {} is not after t = {}", t_end, state_.time());
    StepResult result;
    for (int n = 0; state_.time() < t_end; ++n) {
      if (n == spec_.max_steps)
        return failure(StepStatus::kTooManySteps, fmt::format("{} steps before t_end = {}", n, t_end), result.h);
      const double t0 = state_.time();
      // A step shorter than rounding of the others is none: the last one takes it in.
      const bool last = t_end - t0 <= spec_.step_s * (1.0 + 1e-9);
      const double h = last ? t_end - t0 : spec_.step_s;
      result = step(h, last ? t_end : t0 + h);
      if (!result.ok()) return result;
    }
    return result;
  }

  bool dense_output(double t, VecX& q, VecX& u) const override {
    if (q0_.size() != state_.layout().q_size || t < t0_ || t > t1_ || !(t1_ > t0_)) return false;
    const double s = (t - t0_) / (t1_ - t0_);
    q = (1.0 - s) * q0_ + s * state_.q();
    u = (1.0 - s) * u0_ + s * state_.u();
    project(state_.layout(), q.data());
    system_.impose(state_.layout(), t, q.data(), u.data());
    return true;
  }

  void reinit(ReinitReason) override {  // one-step: there is no history but the dense output's
    ++counters_.reinits;
    t1_ = t0_;
  }

  const StepperCounters& counters() const override {
    solver_.report(counters_);
    return counters_;
  }

 private:
  StepResult failure(StepStatus status, const std::string& what, double h) {
    StepResult result;
    result.status = status;
    result.t = state_.time();
    result.h = h;
    result.order = 1;
    result.message = fmt::format("linearly-implicit-euler: {} (t = {}, h = {})", what, state_.time(), h);
    return result;
  }

  /// s, dv of the derivation above.  A direction carried by a master moves with the master's explicit prediction.
  void predict_drives(double t1, double h) {
    const Layout& layout = state_.layout();
    shift_ = h * state_.u();
    change_.setZero(layout.u_size);
    if (!system_.any_driven()) return;
    q_dot(layout, state_.q().data(), state_.u().data(), q1_.data());
    q1_ = state_.q() + h * q1_;
    u1_ = state_.u();
    system_.impose(layout, t1, q1_.data(), u1_.data());
    for (int dof : system_.driven_dofs()) {
      shift_[dof] = q1_[dof] - state_.q()[dof];
      change_[dof] = u1_[dof] - state_.u()[dof];
    }
  }

  bool right_hand_side(const StateView& at, double h) {
    const ScopedTimer timer(counters_.force_s);
    ++counters_.force_evaluations;
    system_.force(at, rhs_);
    product_.setZero(rhs_.size());
    for (const auto& term : system_.terms())
      if (term->traits().has_tangent) term->apply_tangent(at, 1.0, 0.0, shift_, product_);
    const bool drives_speed_up = (change_.array() != 0.0).any();  // fixed nodes do not
    if (drives_speed_up) {
      for (const auto& term : system_.terms())
        if (term->traits().has_tangent) term->apply_tangent(at, 0.0, 1.0, change_, product_);
    }
    rhs_ = h * (rhs_ - product_);
    if (drives_speed_up) {
      system_.apply_mass(at, change_, product_);
      rhs_ -= product_;
    }
    system_.reduce(at, rhs_);
    return rhs_.allFinite();
  }

  StepResult step(double h, double t1) {
    const Layout& layout = state_.layout();
    q1_.resize(layout.q_size);
    predict_drives(t1, h);
    const StateView at = state_.view(t1, state_.q().data(), state_.u().data());
    if (!right_hand_side(at, h)) return failure(StepStatus::kNotFinite, "the force is not finite", h);
    const auto assemble = [&] {
      const ScopedTimer timer(counters_.tangent_s);
      ++counters_.tangent_evaluations;
      system_.step_matrix(at, 1.0, h, h * h, A_);
    };
    assemble();
    if (solver_.factor(A_, system_, assemble) != SolveStatus::kOk || solver_.solve(rhs_, du_) != SolveStatus::kOk)
      return failure(StepStatus::kSolverFailed, "the step matrix is singular or not finite", h);
    if (!du_.allFinite()) return failure(StepStatus::kNotFinite, "the velocity is not finite", h);
    accept(h, t1);
    StepResult result;
    result.t = t1;
    result.h = h;
    result.order = 1;
    result.iterations = 1;
    return result;
  }

  void accept(double h, double t1) {
    const Layout& layout = state_.layout();
    q0_ = state_.q();
    u0_ = state_.u();
    t0_ = state_.time();
    t1_ = t1;
    state_.u() += du_;
    q_dot(layout, q0_.data(), state_.u().data(), q1_.data());
    state_.q() += h * q1_;
    project(layout, state_.q().data());
    state_.set_time(t1);
    system_.impose(layout, t1, state_.q().data(), state_.u().data());
    ++counters_.steps;
    ++counters_.newton_iterations;
  }

  System& system_;
  State& state_;
  IntegratorSpec spec_;
  StepSolver solver_;
  mutable StepperCounters counters_;
  BorderedMatrix A_;
  VecX shift_, change_, rhs_, product_, du_, q0_, u0_, q1_, u1_;
  double t0_ = 0.0, t1_ = 0.0;  ///< the last step
};

}  // namespace

std::unique_ptr<Stepper> make_linearly_implicit_euler(System& system, State& state, const IntegratorSpec& spec, std::unique_ptr<LinearSolver> solver) {
  return std::make_unique<LinearlyImplicitEuler>(system, state, spec, std::move(solver));
}

}  // namespace palpate::integrate
