#include <algorithm>

#include "integrate/fixed_step/implicit_step.h"
#include "integrate/make.h"
#include "integrate/settings.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

/// Generalized-alpha (Chung and Hulbert 1993) with equilibrium at the end of each step (Arnold and Bruels
/// 2007), with r = spectral_radius the spectral radius at infinite frequency:
///     am = (2 r - 1)/(r + 1),  af = r/(r + 1),  gamma = 1/2 - am + af,  beta = (1 - am + af)^2/4
///     u1 = u0 + h ((1 - gamma) a0 + gamma a1),     q1 = q0 (+) [h u0 + h^2 ((1/2 - beta) a0 + beta a1)]
///     (1 - am) a1 + am a0 = (1 - af) g1 + af g0,   M(q1) g1 = f(q1, u1, t1).
/// g is the acceleration, a an auxiliary variable that lags behind it. A Stage in the unknown a1, weight 1:
///     g1 = c_a a1 + a_c,   c_a = (1 - am)/(1 - af),  a_c = (am a0 - af g0)/(1 - af);
/// matrix c_a M + gamma h D + beta h^2 K.
///
/// On linear systems this equals the method with f at the generalized midpoint, q = (1 - af) q1 + af q0 and u
/// alike (Kuhl and Crisfield 1999). Where f has a kink within a step it does not: friction at the midpoint
/// opposes a velocity that differs from the velocity of the step, so that it may add energy, and constrains
/// the end as little as a gap at the midpoint does. A block on an incline at 1.01 times its friction angle
/// was thrown 3 cm high. Friction at the end is within its cone there, and opposes u1.
///
/// Order 2 for any r in [0, 1] (by the choice of gamma). a0 = u'(t0 + (am - af) h) + O(h^2) (Arnold and
/// Bruels 2007), so where h changes a0 is shifted along its last difference by (am - af) times the change (by
/// at most four old steps); without this shift uneven steps would reduce the order to 1. At a start a0 is
/// M^-1 f0, or where friction sticks the acceleration of a backward Euler step
/// (ImplicitStep::start_acceleration).
/// Where a contact query changed the force but not the state, the method does not restart: a and g belong to
/// the previous force, and the change of the force, which is seldom large, enters with the next g1. M^-1 f in
/// their place is unbounded where forces are stiff, and the position keeps (1/2 - beta) h^2 of it: a tool
/// with 1e-6 of a cube's density was thrown 1e4 times its path length.
///
/// Stability: A-stable. At infinite frequency all three roots are -r: high frequencies decay by r per step, r
/// = 1 keeps them (no damping, Newmark's method), r = 0 removes them in three steps; damping at low
/// frequencies is the least possible for that r. Stiff order 2: e1 = R e0 + O(h^2) with |R| -> r; the defect
/// is smooth and (I - R) is invertible there, so it does not accumulate.
class GeneralizedAlpha final : public ImplicitStep {
 public:
  GeneralizedAlpha(System& system, State& state, const IntegratorSpec& spec,
                   std::unique_ptr<LinearSolver> solver)
      : ImplicitStep("generalized-alpha", 2, Between::kCubic, system, state, spec, std::move(solver)) {
    check_spectral_radius(spec_);
    const double r = spec_.spectral_radius;
    am_ = (2.0 * r - 1.0) / (r + 1.0);
    af_ = r / (r + 1.0);
    gamma_ = 0.5 - am_ + af_;
    beta_ = 0.25 * (1.0 - am_ + af_) * (1.0 - am_ + af_);
    stage_.c_a = (1.0 - am_) / (1.0 - af_);
  }

 private:
  Attempt attempt(double h, double t1) override {
    if (end_a_.size() != layout().u_size) {
      if (!start_acceleration(h, t1, end_a_)) {
        end_a_.resize(0);
        return {.status = StepStatus::kNotFinite, .what = "the force is not finite"};
      }
      end_g_ = end_a_;
      difference_.setZero(layout().u_size);
      last_h_ = h;
    }
    const double change = std::clamp((h - last_h_) / last_h_, -kFarthest, kFarthest);
    start_a_ = end_a_ + (am_ - af_) * change * difference_;
    stage_.t1 = t1;
    stage_.c_u = gamma_ * h;
    stage_.c_theta = beta_ * h * h;
    stage_.u = state_.u() + (1.0 - gamma_) * h * start_a_;
    stage_.theta = h * state_.u() + (0.5 - beta_) * h * h * start_a_;
    stage_.a_c = (am_ * start_a_ - af_ * end_g_) / (1.0 - af_);
    a_ = start_a_;
    return solve_stage();
  }
  void accepted(double h) override {
    ImplicitStep::accepted(h);
    difference_ = a_ - start_a_;
    end_a_ = a_;
    end_g_ = stage_.c_a * a_ + stage_.a_c;
    last_h_ = h;
  }
  void forget(ReinitReason reason) override {
    ImplicitStep::forget(reason);
    if (reason != ReinitReason::kContactRefreshed) end_a_.resize(0);
  }

  static constexpr double kFarthest = 4.0;
  double am_, af_, gamma_, beta_;
  double last_h_ = 0.0;                ///< Step that difference_ was taken over.
  VecX start_a_, end_a_, difference_;  ///< a0 and a1 of the last step, and a1 - a0.
  VecX end_g_;                         ///< g1 of the last step.
};

}  // namespace

std::unique_ptr<Stepper> make_generalized_alpha(System& system, State& state, const IntegratorSpec& spec,
                                                std::unique_ptr<LinearSolver> solver) {
  return std::make_unique<GeneralizedAlpha>(system, state, spec, std::move(solver));
}

}  // namespace palpate::integrate
