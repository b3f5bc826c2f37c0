#include "core/finite.h"
#include "integrate/fixed_step/fixed_step.h"
#include "integrate/fixed_step/linearized_step.h"
#include "integrate/make.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

/// Backward differences of order 1 or 2 with the force linearized about the start of the step, (q0, u0) at
/// the time t1 = t0 + h of the implicit rule: one linear solve per step. With r = h/h_before, c = r^2/(1 + 2
/// r), g = h (1 + r)/(1 + 2 r) (bdf2.cpp), or c = 0, g = h for order 1,
///     u1 = u0 + w + g a,   q1 = q0 (+) theta,   theta = c theta_before + g u1,   w = c (u0 - u_before),
///     M a = f1,   f1 = f - K theta - D (u1 - u0),
/// where theta_before is the displacement of the last step. In the unknown du = u1 - u0,
///     free directions:  (M + g D + g^2 K) du = g (f - K s) + M w,   s = c theta_before + g u0.
/// Driven directions move to x(t1), v(t1) exactly. Their displacement dx and velocity change dv enter the
/// free rows unchanged,
///     (M + g D + g^2 K) du = g (f - K s - D dv) - M (dv - w),
///     s as above on free directions, dx on driven ones;   dv = 0 on free ones, w = 0 on driven ones,
/// so no force acts in a body that moves rigidly with its drive.
///
/// Order 1: the step of Baraff and Witkin (1998), as in Galoppo et al. (2007). L-stable on linear problems
/// with M, D, K positive.
///
/// Order 2: the linearized force errs by O(h^2), so the velocity by O(h^3) per step. On linear problems the
/// force is its linearization, and the method is BDF2: A-stable at constant steps, L-stable, stiff order 2. A
/// step of order 1 is taken after re-initialisation, where r is too large for zero-stability, and where
/// friction began to stick or to slide in the last step (bdf2.cpp has the reasons); its error, O(h^2) once,
/// leaves the order. Where contact begins, the kink of the force lies within a step: the error of that step
/// is O(h^2) in the velocity for both orders.
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
  /// Sets g_, c_ and the start of the step.
  void choose_formula(double h) {
    g_ = h;
    c_ = 0.0;
    if (!two_steps_) return;
    u_start_ = state_.u();
    sticks_ = has_onset();
    if (theta_before_.size() != layout().u_size || h > kLargestRatio * h_before_ || sticks_ != stuck_) return;
    const double r = h / h_before_;
    g_ = h * (1.0 + r) / (1.0 + 2.0 * r);
    c_ = r * r / (1.0 + 2.0 * r);
  }

  /// Computes s, dv and w of the derivation above. A direction carried by a master moves with the master's
  /// explicit prediction.
  void predict(double t1) {
    shift_ = g_ * state_.u();
    if (c_ != 0.0) {
      shift_ += c_ * theta_before_;
      momentum_ = c_ * (u_start_ - u_before_);
      for (const int dof : system_.driven_dofs()) momentum_[dof] = 0.0;
    }
    if (drives_speed_up_ || change_.size() != layout().u_size) change_.setZero(layout().u_size);
    drives_speed_up_ = false;
    is_proportional_ = c_ == 0.0;
    if (!system_.any_driven()) return;
    if (system_.any_master()) {  // Otherwise the imposed values depend on time alone.
      q_dot(layout(), state_.q().data(), shift_.data(), q1_.data());
      q1_ += state_.q();
      u1_ = state_.u();
    }
    system_.impose(layout(), t1, q1_.data(), u1_.data());
    for (int dof : system_.driven_dofs()) {
      shift_[dof] = q1_[dof] - state_.q()[dof];
      change_[dof] = u1_[dof] - state_.u()[dof];
      drives_speed_up_ = drives_speed_up_ || change_[dof] != 0.0;           // Always false for fixed nodes.
      is_proportional_ = is_proportional_ && shift_[dof] == g_ * u1_[dof];  // Always true for these.
    }
  }

  /// Computes the state after a velocity change du: of the nodes, which come first with q' = u, in one pass
  /// per vector.
  void move() {
    const Eigen::Index nodal = layout().nodal_size;
    auto u1 = u1_.head(nodal), q1 = q1_.head(nodal);
    u1 = state_.u().head(nodal) + du_.head(nodal);
    if (c_ != 0.0)
      q1 = state_.q().head(nodal) + (c_ * theta_before_.head(nodal) + g_ * u1);
    else
      q1 = state_.q().head(nodal) + g_ * u1;
    for (const Block& block : layout().blocks)
      if (block.kind != BlockKind::kNodes) move(block);
  }
  void move(const Block& rigid) {
    const auto of_q = [&](auto&& v) { return v.segment(rigid.q_offset, rigid.q_size); };
    const auto of_u = [&](auto&& v) { return v.segment(rigid.u_offset, rigid.u_size); };
    auto u1 = of_u(u1_), q1 = of_q(q1_);
    const auto q0 = of_q(state_.q());
    u1 = of_u(state_.u()) + of_u(du_);
    theta_ = g_ * u1;
    if (c_ != 0.0) theta_ += c_ * of_u(theta_before_);
    if (!rigid.kinematics) {
      q1 = theta_ + q0;
      return;
    }
    rigid.kinematics->q_dot(q0, theta_, q1);
    q1 += q0;
    rigid.kinematics->project(q1);
  }

  Attempt attempt(double h, double t1) override {
    choose_formula(h);
    predict(t1);
    const StateView at = state_.view(t1, state_.q().data(), state_.u().data());
    const StepStatus status = equations_.solve(
        {at, g_, shift_, change_, !drives_speed_up_, c_ != 0.0 ? &momentum_ : nullptr, is_proportional_}, du_,
        counters_);
    if (status == StepStatus::kNotFinite) return {.status = status, .what = "the force is not finite"};
    if (status != StepStatus::kOk)
      return {.status = status, .what = "the step matrix is singular or not finite"};
    if (!all_finite(du_)) return {.status = StepStatus::kNotFinite, .what = "the velocity is not finite"};
    move();
    system_.impose(layout(), t1, q1_.data(), u1_.data());
    return {.iterations = 1};
  }

  void accepted(double h) override {
    if (!two_steps_) return;
    theta_before_ = shift_ + g_ * du_;
    u_before_.swap(u_start_);
    h_before_ = h;
    stuck_ = sticks_;
  }
  void forget(ReinitReason) override {
    equations_.forget();
    theta_before_.resize(0);
  }
  void collect(StepperCounters& counters) const override { equations_.report(counters); }

  static constexpr double kLargestRatio = 2.4;  // Less than 1 + sqrt(2): zero-stability.
  const bool two_steps_;
  LinearizedStep equations_;
  double g_ = 0.0, c_ = 0.0, h_before_ = 0.0;
  bool sticks_ = false, stuck_ = false;  ///< At the start of this step, and of the previous one.
  VecX shift_, change_, momentum_, du_, theta_;
  VecX u_start_, u_before_, theta_before_;
  bool drives_speed_up_ = false;  ///< change_ is not zero.
  bool is_proportional_ = false;  ///< s = g (u0 + dv).
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
