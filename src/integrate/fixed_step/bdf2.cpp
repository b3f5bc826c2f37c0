#include <cmath>

#include "integrate/fixed_step/implicit_step.h"
#include "integrate/make.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

/// Backward differences of order 2 with a variable step (Hairer, Norsett, Wanner, III.5): with r =
/// h/h_before, c = r^2/(1 + 2 r), g = h (1 + r)/(1 + 2 r),
///     M(q1) a = f(q1, u1, t1),   u1 = u0 + c (u0 - u_before) + g a,   q1 = q0 (+) [c theta_before + g u1],
/// where theta_before is the displacement of the last step (q0 = q_before (+) theta_before). At r = 1: c =
/// 1/3, g = 2h/3.
/// A Stage in the unknown a with theta = c theta_before + g (u0 + c (u0 - u_before)) + g^2 a and the matrix M
/// + g D + g^2 K. The displacements of a rigid body are rotations relative to q0; their rate differs from w
/// by O(h^2): order 2 there as well.
///
/// A starting step is taken after re-initialisation, where sticking or sliding of friction began in the
/// previous step, and where r > 1 + sqrt(2) (beyond which steps that keep growing are not zero-stable). At
/// the onset of sliding u has a kink: the two-step formula would extrapolate the speed v_r, which regularised
/// friction reaches at once, by v_r/3 + v_r/9 + ... = v_r/2, permanently. The starting step is the L-stable
/// SDIRK method of order 2 (Alexander 1977), s = 1 - 1/sqrt(2),
///     u_s = u0 + s h a_s,                          q_s = q0 (+) s h u_s,
///     u1 = u0 + (1 - s) h a_s + s h a,             q1 = q0 (+) [(1 - s) h u_s + s h u1],
/// two Stages with the matrix M + s h D + (s h)^2 K. A restart therefore does not reduce the order, as a
/// backward Euler step at every exchange would.
///
/// Order 2. Stability: A-stable at constant steps, and L-stable: for z -> infinity both roots of (3/2 - z)
/// R^2 - 2 R + 1/2 = 0 vanish like z^(-1/2). Stiff order 2: on u' = -l (u - g) + g' with l h >> 1 the error
/// is the defect over l, h^2 g'''/(3 l) at constant steps: no order reduction.
class Bdf2 final : public ImplicitStep {
 public:
  Bdf2(System& system, State& state, const IntegratorSpec& spec, std::unique_ptr<LinearSolver> solver)
      : ImplicitStep("bdf2", 2, Between::kCubic, system, state, spec, std::move(solver)) {}

 private:
  Attempt attempt(double h, double t1) override {
    u_start_ = state_.u();
    sticks_ = sticks();
    const bool two_steps =
        theta_before_.size() == layout().u_size && h <= kLargestRatio * h_before_ && sticks_ == stuck_;
    return two_steps ? step(h, t1) : start(h, t1);
  }

  Attempt step(double h, double t1) {
    const double r = h / h_before_, c = r * r / (1.0 + 2.0 * r), g = h * (1.0 + r) / (1.0 + 2.0 * r);
    stage_.t1 = t1;
    stage_.c_u = g;
    stage_.c_theta = g * g;
    stage_.u = state_.u() + c * (state_.u() - u_before_);
    stage_.theta = c * theta_before_ + g * stage_.u;
    guess();
    return solve_stage();
  }

  Attempt start(double h, double t1) {
    static const double s = 1.0 - 1.0 / std::sqrt(2.0);
    stage_.t1 = state_.time() + s * h;
    stage_.c_u = s * h;
    stage_.c_theta = s * h * s * h;
    stage_.u = state_.u();
    stage_.theta = s * h * state_.u();
    guess();
    const Attempt first = solve_stage();
    if (first.status != StepStatus::kOk) return first;
    u_stage_ = stage_.u + s * h * a_;
    stage_.t1 = t1;
    stage_.u = state_.u() + (1.0 - s) * h * a_;
    stage_.theta = (1.0 - s) * h * u_stage_ + s * h * stage_.u;
    return solve_stage(first);
  }

  void accepted(double h) override {
    ImplicitStep::accepted(h);
    theta_before_ = stage_.theta + stage_.c_theta * a_;
    u_before_ = u_start_;
    h_before_ = h;
    stuck_ = sticks_;
  }
  void forget(ReinitReason reason) override {
    ImplicitStep::forget(reason);
    theta_before_.resize(0);
  }

  static constexpr double kLargestRatio = 2.4;  // Less than 1 + sqrt(2).
  double h_before_ = 0.0;
  bool sticks_ = false, stuck_ = false;  ///< At the start of this step, and of the previous one.
  VecX u_before_, theta_before_, u_stage_, u_start_;
};

}  // namespace

std::unique_ptr<Stepper> make_bdf2(System& system, State& state, const IntegratorSpec& spec,
                                   std::unique_ptr<LinearSolver> solver) {
  return std::make_unique<Bdf2>(system, state, spec, std::move(solver));
}

}  // namespace palpate::integrate
