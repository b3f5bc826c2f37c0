#include <cmath>

#include "core/finite.h"
#include "integrate/fixed_step/fixed_step.h"
#include "integrate/fixed_step/linearized_step.h"
#include "integrate/make.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

/// Backward differences with one linear solve per step. With r = h/h_before, c = r^2/(1 + 2 r), g = h (1 +
/// r)/(1 + 2 r) for order 2 (bdf2.cpp), c = 0, g = h for order 1, the implicit formula is
///     M u1 = M v + g f(q1, u1),   v = u0 + c (u0 - u_before),   q1 = q0 (+) theta,
///     theta = c theta_before + g u1,
/// where theta_before is the displacement of the last step. The orders differ in the state about which the
/// force is linearized.
///
/// Order 1, about the start (q0, u0) at the time t1 = t0 + h of the implicit rule: the step of Baraff and
/// Witkin (1998), as in Galoppo et al. (2007), f1 = f - K h u1 - D (u1 - u0), with du = u1 - u0
///     free directions:  (M + h D + h^2 K) du = h (f - h K u0)
/// Driven directions move to x(t1), v(t1) exactly. Their displacement dx and velocity change dv enter the
/// free rows unchanged,
///     (M + h D + h^2 K) du = h (f - K s - D dv) - M dv,
///     s = h u0 on free directions, dx on driven ones;   dv = 0 on free ones,
/// so no force acts in a body that moves rigidly with its drive. L-stable on linear problems with M, D, K
/// positive.
///
/// Order 2: a Stage of length g with the velocity v and the displacement theta = b + g u at its end,
///     M u = M v + g f(q0 (+) theta, u, t),
/// is linearized about the state that it has without any force, velocity v, displacement b + g v, driven
/// directions at x(t). In du = u - v all terms but those of driven velocities vanish,
///     (M + g D + g^2 K) du = g (f(q0 (+) (b + g v), v, t) - D dv) - M dv,   dv = v(t) - v on driven ones,
/// one step of Newton's method. v errs by O(h), the displacement by O(h^2): the force and M(q) a, which turns
/// with a rigid body, err by O(h^2), the velocity by O(h^3) per step. (About the start M(q) a would err by
/// O(h), and the order would be 1 for bodies that turn.) A step of BDF2 is one Stage,
///     v = u0 + c (u0 - u_before),   b = c theta_before,   t = t1;
/// its starting step, by Alexander's SDIRK method (bdf2.cpp), two with g = s h, s = 1 - 1/sqrt(2):
///     v = u0,   b = 0,   t = t0 + s h,   giving u_s;
///     v = u0 + (1/s - 1) (u_s - u0),   b = (1 - s) h u_s,   t = t1.
/// On linear problems the method is BDF2: A-stable at constant steps, L-stable, stiff order 2. Starting steps
/// are taken after re-initialisation, and where r is too large for zero-stability. Steps with friction are of
/// order 1: friction has kinks, and its solves (dynamics::RepeatedStepTerm) start from the start of the step.
///
/// A value that is not finite is returned as a status. Dense output within the last step: linear, or cubic
/// for order 2.
class LinearlyImplicit final : public FixedStep {
 public:
  LinearlyImplicit(std::string name, int order, System& system, State& state, const IntegratorSpec& spec,
                   std::unique_ptr<LinearSolver> solver)
      : FixedStep(std::move(name), order, order == 1 ? Between::kLinear : Between::kCubic, system, state,
                  spec),
        two_steps_(order == 2),
        equations_(system, std::move(solver), spec) {}

 private:
  Attempt attempt(double h, double t1) override {
    const StateView at = state_.view(t1, state_.q().data(), state_.u().data());
    if (LinearizedStep::Repeats friction(equations_, at); !two_steps_ || friction.any()) {
      if (two_steps_) u_start_ = state_.u();
      const Attempt out = step_of_order_1(h, at, friction);
      if (two_steps_ && out.status == StepStatus::kOk) theta_ = shift_ + h * du_;
      return out;
    }
    u_start_ = state_.u();
    const bool goes_on = theta_before_.size() == layout().u_size && h <= kLargestRatio * h_before_;
    return goes_on ? step_of_order_2(h, t1) : start(h, t1);
  }

  Attempt step_of_order_1(double h, const StateView& at, LinearizedStep::Repeats& friction) {
    predict_drives(at.time, h);
    const LinearizedEquations equations{at, h, shift_, change_, !drives_speed_up_, is_proportional_};
    const Attempt solved = checked(equations_.solve(equations, friction, du_, counters_));
    if (solved.status != StepStatus::kOk) return solved;
    move(h);
    system_.impose(layout(), at.time, q1_.data(), u1_.data());
    return solved;
  }

  Attempt step_of_order_2(double h, double t1) {
    const double r = h / h_before_, g = h * (1.0 + r) / (1.0 + 2.0 * r), c = r * r / (1.0 + 2.0 * r);
    v_ = u_start_ + c * (u_start_ - u_before_);
    base_ = c * theta_before_;
    return stage(g, t1);
  }

  Attempt start(double h, double t1) {
    static const double s = 1.0 - 1.0 / std::sqrt(2.0);
    v_ = u_start_;
    base_.setZero(layout().u_size);
    const Attempt first = stage(s * h, state_.time() + s * h);
    if (first.status != StepStatus::kOk) return first;
    v_ = u_start_ + (1.0 / s - 1.0) * (u1_ - u_start_);
    base_ = (1.0 - s) * h * u1_;
    Attempt second = stage(s * h, t1);
    second.iterations += first.iterations;
    return second;
  }

  /// Solves a Stage with v_ and the displacement base_; the result is in u1_, q1_ and theta_.
  Attempt stage(double g, double t) {
    u1_ = v_;
    displace(g, t, u1_, q_predicted_);
    shift_.setZero(layout().u_size);
    change_.setZero(layout().u_size);
    bool drives_speed_up = false;
    for (const int dof : system_.driven_dofs()) {
      change_[dof] = u1_[dof] - v_[dof];
      drives_speed_up = drives_speed_up || change_[dof] != 0.0;
    }
    const StateView at = state_.view(t, q_predicted_.data(), v_.data());
    const Attempt solved =
        checked(equations_.solve({at, g, shift_, change_, !drives_speed_up}, du_, counters_));
    if (solved.status != StepStatus::kOk) return solved;
    u1_ += du_;
    displace(g, t, u1_, q1_);
    for (const int dof : system_.driven_dofs()) theta_[dof] = q1_[dof] - state_.q()[dof];
    return solved;
  }

  Attempt checked(StepStatus status) const {
    if (status == StepStatus::kNotFinite) return {.status = status, .what = "the force is not finite"};
    if (status != StepStatus::kOk)
      return {.status = status, .what = "the step matrix is singular or not finite"};
    if (!all_finite(du_)) return {.status = StepStatus::kNotFinite, .what = "the velocity is not finite"};
    return {.iterations = 1};
  }

  /// Computes theta_ = base_ + g u and q = q0 (+) theta_, with u and q of driven directions as at the time t.
  void displace(double g, double t, VecX& u, VecX& q) {
    theta_ = base_ + g * u;
    q.resize(layout().q_size);
    q_dot(layout(), state_.q().data(), theta_.data(), q.data());
    q += state_.q();
    project(layout(), q.data());
    system_.impose(layout(), t, q.data(), u.data());
  }

  /// Computes s and dv of order 1. A direction carried by a master moves with the master's explicit
  /// prediction.
  void predict_drives(double t1, double h) {
    shift_ = h * state_.u();
    if (drives_speed_up_ || change_.size() != layout().u_size) change_.setZero(layout().u_size);
    drives_speed_up_ = false;
    is_proportional_ = true;
    if (!system_.any_driven()) return;
    if (system_.any_master()) {  // Otherwise the imposed values depend on time alone.
      q_dot(layout(), state_.q().data(), state_.u().data(), q1_.data());
      q1_ = state_.q() + h * q1_;
      u1_ = state_.u();
    }
    system_.impose(layout(), t1, q1_.data(), u1_.data());
    for (int dof : system_.driven_dofs()) {
      shift_[dof] = q1_[dof] - state_.q()[dof];
      change_[dof] = u1_[dof] - state_.u()[dof];
      drives_speed_up_ = drives_speed_up_ || change_[dof] != 0.0;          // Always false for fixed nodes.
      is_proportional_ = is_proportional_ && shift_[dof] == h * u1_[dof];  // Always true for these.
    }
  }

  /// Computes the state after a velocity change du of order 1: of the nodes, which come first with q' = u, in
  /// one pass per vector.
  void move(double h) {
    const Eigen::Index nodal = layout().nodal_size;
    auto u1 = u1_.head(nodal), q1 = q1_.head(nodal);
    u1 = state_.u().head(nodal) + du_.head(nodal);
    q1 = state_.q().head(nodal) + h * u1;
    for (const Block& block : layout().blocks)
      if (block.kind != BlockKind::kNodes) move(block, h);
  }
  void move(const Block& rigid, double h) {
    const auto of_q = [&](auto&& v) { return v.segment(rigid.q_offset, rigid.q_size); };
    const auto of_u = [&](auto&& v) { return v.segment(rigid.u_offset, rigid.u_size); };
    auto u1 = of_u(u1_), q1 = of_q(q1_);
    const auto q0 = of_q(state_.q());
    u1 = of_u(state_.u()) + of_u(du_);
    if (!rigid.kinematics) {
      q1 = q0 + h * u1;
      return;
    }
    rigid.kinematics->q_dot(q0, u1, q1);
    q1 = q0 + h * q1;
    rigid.kinematics->project(q1);
  }

  void accepted(double h) override {
    if (!two_steps_) return;
    theta_before_.swap(theta_);
    u_before_.swap(u_start_);
    h_before_ = h;
  }
  /// A contact query changes neither the bodies' part of the matrix nor the state. Its part is assembled in
  /// each step.
  void forget(ReinitReason reason) override {
    if (reason == ReinitReason::kContactRefreshed) return;
    equations_.forget();
    theta_before_.resize(0);
  }
  void collect(StepperCounters& counters) const override { equations_.report(counters); }

  static constexpr double kLargestRatio = 2.4;  // Less than 1 + sqrt(2): zero-stability.
  const bool two_steps_;
  LinearizedStep equations_;
  VecX shift_, change_, du_;
  bool drives_speed_up_ = false;  ///< change_ is not zero.
  bool is_proportional_ = false;  ///< s = h (u0 + dv).
  double h_before_ = 0.0;
  VecX u_start_, u_before_;    ///< u at the start of this step, and of the previous one.
  VecX theta_, theta_before_;  ///< Displacements of both steps.
  VecX v_, base_;              ///< v and b of the current Stage.
  VecX q_predicted_;           ///< Positions at its end without any force.
};

}  // namespace

std::unique_ptr<Stepper> make_linearly_implicit_euler(System& system, State& state,
                                                      const IntegratorSpec& spec,
                                                      std::unique_ptr<LinearSolver> solver) {
  return std::make_unique<LinearlyImplicit>("linearly-implicit-euler", 1, system, state, spec,
                                            std::move(solver));
}

std::unique_ptr<Stepper> make_linearly_implicit_bdf2(System& system, State& state, const IntegratorSpec& spec,
                                                     std::unique_ptr<LinearSolver> solver) {
  return std::make_unique<LinearlyImplicit>("linearly-implicit-bdf2", 2, system, state, spec,
                                            std::move(solver));
}

}  // namespace palpate::integrate
