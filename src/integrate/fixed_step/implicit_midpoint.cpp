#include "integrate/fixed_step/implicit_step.h"
#include "integrate/make.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

/// Implicit midpoint rule, the Gauss method of one stage (Hairer, Lubich, Wanner, Geometric Numerical
/// Integration, II.1 and VI.4):
///     M(q_m) (u1 - u0)/h = f(q_m, u_m, t_m),     q1 = q0 + h N(q_m) u_m,
///     q_m = (q0 + q1)/2,  u_m = (u0 + u1)/2,  t_m = (t0 + t1)/2.
/// In the unknown a = (u1 - u0)/h this is a Stage with u1 = u0 + h a, theta = h u0 + h^2/2 a, weight 1/2 and
/// the matrix M + h/2 D + h^2/4 K.
///
/// Order 2, symmetric, symplectic. Quadratic invariants are conserved to Newton's tolerance: energy of a
/// linear system, momentum and angular momentum of nodes (sum of m x cross v), the length of quaternions. In
/// these coordinates the angular momentum R I R^T w of a rigid body is not quadratic: its error is O(h^2),
/// without drift (the method is symmetric, a free body reversible). For a body that spins at an unresolved
/// rate forces are evaluated at its mean shape (q0 + q1)/2, shrunk by cos(w h/2): this is the cost of the
/// invariants.
/// Stability: R(z) = (1 + z/2)/(1 - z/2): A-stable, |R(iy)| = 1, R(infinity) = -1: modes that the step does
/// not resolve are not damped but alternate from step to step.
/// Stiff order 2: on u' = -l (u - g) + g' with l h >> 1, e1 = R e0 + O(h^2) g'' with R near -1: the
/// defects of adjacent steps cancel up to O(h^3), so the order remains 2 (Kraaijevanger 1985), but a
/// deviation from the smooth solution at the start is not reduced.
class ImplicitMidpoint final : public ImplicitStep {
 public:
  ImplicitMidpoint(System& system, State& state, const IntegratorSpec& spec,
                   std::unique_ptr<LinearSolver> solver)
      : ImplicitStep("implicit-midpoint", 2, Between::kCubic, system, state, spec, std::move(solver)) {
    stage_.weight = 0.5;
  }

 private:
  Attempt attempt(double h, double t1) override {
    stage_.t1 = t1;
    stage_.c_u = h;
    stage_.c_theta = 0.5 * h * h;
    stage_.u = state_.u();
    stage_.theta = h * state_.u();
    guess();
    return solve_stage();
  }
};

}  // namespace

std::unique_ptr<Stepper> make_implicit_midpoint(System& system, State& state, const IntegratorSpec& spec,
                                                std::unique_ptr<LinearSolver> solver) {
  return std::make_unique<ImplicitMidpoint>(system, state, spec, std::move(solver));
}

}  // namespace palpate::integrate
