#include <cmath>

#include "integrate/fixed_step/fixed_step.h"
#include "integrate/make.h"
#include "integrate/step_solver.h"
#include "palpate/core/clock.h"
#include "palpate/core/finite.h"

namespace palpate::integrate {
namespace {

using namespace dynamics;

constexpr double kSameStep = 1e-6;  // relative: steps that differ by rounding

/// Baraff and Witkin (1998), the step of Galoppo et al. (2007).  M (u1 - u0) = h f(q1, u1), q1 = q0 + h N u1,
/// with the force made linear about (q0, u0) at the time t1 = t0 + h of the implicit rule, f1 = f - K h u1 -
/// D (u1 - u0):
///     free directions:  (M + h D + h^2 K) du = h (f - h K u0)
/// Driven directions go to x(t1), v(t1) exactly.  Their displacement dx and velocity change dv enter the free
/// rows as what they are,
///     (M + h D + h^2 K) du = h (f - K s - D dv) - M dv,   s = h u0 on free directions, dx on driven ones;
///     dv = 0 on free ones,
/// so a body that moves rigidly with its drive feels no force.  Order 1; L-stable on linear problems with M,
/// D, K positive. A value that is not finite ends the step as data; an indefinite matrix is met as StepSolver
/// says.  With a projected one, K_p, the right-hand side takes K_p as well, so that the step is
///     (M + h D + h^2 K_p) u1 = M u0 + h f + ...,
/// that of a force model without negative curvature: it may not gain energy.  K itself there, h^2 (K_p - K)
/// u0 more, pushes a moving body along that curvature, which where elements are flat has no bound.  Where h
/// is small enough for the order to show, matrices are definite.
/// A body that moves little in a step leaves its matrix nearly as it was: the solver then takes the one that
/// it has, and looks at what the true K and D leave, without their matrix (LinearSolver::solve_near).
/// Dense output is linear within the last step, which has the method's order.
class LinearlyImplicitEuler final : public FixedStep {
 public:
  LinearlyImplicitEuler(System& system, State& state, const IntegratorSpec& spec,
                        std::unique_ptr<LinearSolver> solver)
      : FixedStep("linearly-implicit-euler", 1, Between::kLinear, system, state, spec),
        solver_(std::move(solver), spec) {}

 private:
  /// s, dv of the derivation above.  A direction carried by a master moves with the master's explicit
  /// prediction.
  void predict_drives(double t1, double h) {
    shift_ = h * state_.u();
    if (drives_speed_up_ || change_.size() != layout().u_size) change_.setZero(layout().u_size);
    drives_speed_up_ = false;
    if (!system_.any_driven()) return;
    if (layout().border_size() > 0) {  // masters; without one, what is imposed depends on time alone
      q_dot(layout(), state_.q().data(), state_.u().data(), q1_.data());
      q1_ = state_.q() + h * q1_;
      u1_ = state_.u();
    }
    system_.impose(layout(), t1, q1_.data(), u1_.data());
    for (int dof : system_.driven_dofs()) {
      shift_[dof] = q1_[dof] - state_.q()[dof];
      change_[dof] = u1_[dof] - state_.u()[dof];
      drives_speed_up_ = drives_speed_up_ || change_[dof] != 0.0;  // of fixed nodes none is
    }
  }

  bool right_hand_side(const StateView& at, double h) {
    const ScopedTimer timer(counters_.force_s);
    ++counters_.force_evaluations;
    system_.force(at, rhs_);
    product_.setZero(rhs_.size());
    for (const auto& term : system_.terms())
      if (term->traits().has_tangent) term->apply_tangent(at, 1.0, 0.0, shift_, product_);
    rhs_ -= product_;
    return complete(at, h);
  }

  /// From f - K s to the whole right-hand side; false where it is not finite.
  bool complete(const StateView& at, double h) {
    if (drives_speed_up_) {
      product_.setZero(rhs_.size());
      for (const auto& term : system_.terms())
        if (term->traits().has_tangent) term->apply_tangent(at, 0.0, 1.0, change_, product_);
      rhs_ -= product_;
    }
    rhs_ *= h;
    if (drives_speed_up_) {
      system_.apply_mass(at, change_, product_);
      rhs_ -= product_;
    }
    system_.reduce(at, rhs_);
    if (system_.any_driven()) {  // carried nodes: the turning of G under the force held
      product_.setZero(rhs_.size());
      system_.apply_carried_stiffness(at, shift_, product_);
      rhs_ -= h * product_;
    }
    return all_finite(rhs_);
  }

  /// What a velocity change leaves of the right-hand side.
  class Left final : public Residual {
   public:
    Left(LinearlyImplicitEuler& of, const StateView& at, double h) : of_(of), at_(at), h_(h) {}
    void at(const VecX& x, VecX& r) override { of_.leave(at_, h_, x, r); }

   private:
    LinearlyImplicitEuler& of_;
    const StateView& at_;
    double h_;
  };
  /// r = h (f - K (s + h x) - D (dv + x)) - M (dv + x) on free directions; x is zero on driven ones.
  void leave(const StateView& at, double h, const VecX& x, VecX& r) {
    const ScopedTimer timer(counters_.force_s);
    ++counters_.force_evaluations;
    shift_of_x_ = shift_ + h * x;
    if (drives_speed_up_) change_of_x_ = change_ + x;
    system_.step_left(at, shift_of_x_, drives_speed_up_ ? change_of_x_ : x, h, r);
  }

  /// By the matrix of an earlier step, where that serves.
  bool solve_near(const StateView& at, double h) {
    if (!(std::abs(h - kept_h_) <= kSameStep * h) || !system_.balanced(at) ||
        system_.pattern().pattern_version() != kept_pattern_)
      return false;
    Left left(*this, at, h);
    return solver_.solve_near(left, du_) == SolveStatus::kOk;
  }

  /// Force, product and matrix in one pass over the bodies, and its solution.  kIndefinite: the matrix is.
  /// Anything else but kOk: terms or solver do not take part in that, or the solver fails; the general way
  /// then tells why, or does better.
  SolveStatus solve_balanced(const StateView& at, double h) {
    if (!system_.balanced(at)) return SolveStatus::kNotConverged;
    BalancedMatrix* A = solver_.balanced(system_.pattern());
    if (!A) return SolveStatus::kNotConverged;
    kept_h_ = 0.0;
    {
      const ScopedTimer timer(counters_.tangent_s);
      ++counters_.force_evaluations;
      ++counters_.tangent_evaluations;
      system_.balanced_step(at, shift_, 1.0, h, h * h, rhs_, *A);
    }
    {
      const ScopedTimer timer(counters_.force_s);
      if (!complete(at, h)) return SolveStatus::kSingular;
    }
    SolveStatus status = solver_.factor_balanced();
    const bool rounded = status == SolveStatus::kRounded;
    if (rounded) {
      Left left(*this, at, h);
      status = solver_.solve_near(left, du_);
    } else if (status == SolveStatus::kOk) {
      status = solver_.solve(rhs_, du_);
    }
    if (status == SolveStatus::kIndefinite && !rounded && solver_.projects())
      return solve_definite(at, h, *A);
    if (status != SolveStatus::kOk) return status;
    kept_h_ = h;
    kept_pattern_ = system_.pattern().pattern_version();
    return status;
  }

  /// The same by definite tangents, after kIndefinite.  No step after it is near this matrix.
  SolveStatus solve_definite(const StateView& at, double h, BalancedMatrix& A) {
    {
      const ScopedTimer timer(counters_.tangent_s);
      ++counters_.tangent_evaluations;
      const DefiniteTangents definite(system_);
      system_.balanced_step(at, shift_, 1.0, h, h * h, rhs_, A);
      if (!complete(at, h)) return SolveStatus::kSingular;
    }
    const SolveStatus status = solver_.factor_balanced_definite();
    if (status == SolveStatus::kOk && solver_.solve(rhs_, du_) == SolveStatus::kOk) return SolveStatus::kOk;
    return SolveStatus::kIndefinite;  // as it was: the whole matrix may do better
  }

  /// The general way; not kOk: what went wrong.
  /// @param indefinite  the matrix is known to be
  Attempt solve(const StateView& at, double h, bool indefinite) {
    if (!right_hand_side(at, h)) return {.status = StepStatus::kNotFinite, .what = "the force is not finite"};
    const auto assemble = [&] {
      const ScopedTimer timer(counters_.tangent_s);
      ++counters_.tangent_evaluations;
      system_.step_matrix(at, 1.0, h, h * h, A_);
    };
    SolveStatus status;
    if (indefinite) {
      status = solver_.factor_indefinite(A_, system_, assemble);
    } else {
      assemble();
      status = solver_.factor(A_, system_, assemble);
    }
    bool by_definite = false;  // rhs_ is
    const auto of_the_matrix = [&]() -> const VecX& {
      if (by_definite == solver_.definite()) return rhs_;
      by_definite = solver_.definite();
      if (by_definite) {
        const DefiniteTangents definite(system_);
        right_hand_side(at, h);
      } else {
        right_hand_side(at, h);
      }
      return rhs_;
    };
    if (status == SolveStatus::kOk) status = solver_.solve(system_, assemble, of_the_matrix, du_);
    if (status != SolveStatus::kOk)
      return {.status = StepStatus::kSolverFailed, .what = "the step matrix is singular or not finite"};
    return {};
  }

  /// The state after a velocity change du: nodes in one pass over the vectors.
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
    if (!solve_near(at, h))
      if (const SolveStatus status = solve_balanced(at, h); status != SolveStatus::kOk)
        if (const Attempt solved = solve(at, h, status == SolveStatus::kIndefinite);
            solved.status != StepStatus::kOk)
          return solved;
    if (!all_finite(du_)) return {.status = StepStatus::kNotFinite, .what = "the velocity is not finite"};
    move(h);
    system_.impose(layout(), t1, q1_.data(), u1_.data());
    return {.iterations = 1};
  }
  void forget(ReinitReason) override { kept_h_ = 0.0; }
  void collect(StepperCounters& counters) const override { solver_.report(counters); }

  StepSolver solver_;
  BorderedMatrix A_;
  VecX shift_, change_, rhs_, product_, du_, shift_of_x_, change_of_x_;
  bool drives_speed_up_ = false;  ///< change_ is not zero
  double kept_h_ = 0.0;           ///< step of the balanced matrix that the solver has; 0: none
  std::uint64_t kept_pattern_ = 0;
};

}  // namespace

std::unique_ptr<Stepper> make_linearly_implicit_euler(System& system, State& state,
                                                      const IntegratorSpec& spec,
                                                      std::unique_ptr<LinearSolver> solver) {
  return std::make_unique<LinearlyImplicitEuler>(system, state, spec, std::move(solver));
}

}  // namespace palpate::integrate
