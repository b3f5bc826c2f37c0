#include "integrate/fixed_step/implicit_step.h"
#include "integrate/make.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

/// Backward Euler, with Newton's method iterated to convergence:
///     M(q1) (u1 - u0)/h = f(q1, u1, t1),     q1 = q0 (+) h u1.
/// In the unknown a = (u1 - u0)/h this is a Stage with u1 = u0 + h a, theta = h u0 + h^2 a and the matrix M +
/// h D + h^2 K.
///
/// Order 1: the leading error of a mode w is a spurious damping ratio of w h/2.
/// Stability: a linear mode q'' + 2 z w q' + w^2 q = 0 is advanced by
///     [q; u] <- 1/(1 + 2 z W + W^2) [1 + 2 z W, h; -w^2 h, 1],     W = w h:
/// the determinant is 1/(1 + 2 z W + W^2) < 1 at any step (A-stable), and 0 in the limit (L-stable).
/// Stiff order 1: on u' = -l (u - g) + g' the error satisfies e1 = (e0 + h^2 g''/2)/(1 + h l): no order
/// reduction (h g''/(2 l) where l h >> 1).
class BackwardEuler final : public ImplicitStep {
 public:
  BackwardEuler(System& system, State& state, const IntegratorSpec& spec,
                std::unique_ptr<LinearSolver> solver)
      : ImplicitStep("backward-euler", 1, Between::kLinear, system, state, spec, std::move(solver)) {}

 private:
  Attempt attempt(double h, double t1) override {
    stage_.t1 = t1;
    stage_.c_u = h;
    stage_.c_theta = h * h;
    stage_.u = state_.u();
    stage_.theta = h * state_.u();
    guess();
    return solve_stage();
  }
};

}  // namespace

std::unique_ptr<Stepper> make_backward_euler(System& system, State& state, const IntegratorSpec& spec,
                                             std::unique_ptr<LinearSolver> solver) {
  return std::make_unique<BackwardEuler>(system, state, spec, std::move(solver));
}

}  // namespace palpate::integrate
