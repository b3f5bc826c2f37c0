#pragma once
#include "integrate/newton.h"
#include "integrate/step_solver.h"
#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::integrate {

/// One implicit stage of a mechanical method, in the unknown a (an acceleration, along u-directions):
///     end       u1 = u + c_u a,   theta = theta + c_theta a,   q1 = q0 (+) theta   (displace.h),
///               driven directions at time t1
///     stage     q_s = w q1 + (1 - w) q0,  u_s = w u1 + (1 - w) u0,  t_s = w t1 + (1 - w) t0
///     equation  M(q_s) (a_c + c_a a) = f(q_s, u_s, t_s)   on free directions
/// Newton's matrix is c_a M + w c_u D + w c_theta K, symmetric where the system is. (The derivative of M, and
/// the derivative of the map (+) beyond first order, both of rigid bodies, are left out.) Driven directions
/// enter the stage as the means of their values at the ends, like all others, so no force acts in a body that
/// moves rigidly with its drive, at any step. They are not unknowns (System::residual, step_matrix).
struct Stage {
  double t1 = 0.0, weight = 1.0;  ///< weight: w
  double c_u = 0.0, c_theta = 0.0, c_a = 1.0;
  VecX u, theta, a_c;  ///< The known parts; an empty a_c is zero.
};

/// Newton's method (integrate/newton.h) for a Stage.
/// |.| is the weighted norm of error_weights, with newton_rtol in place of rtol, of the increments (c_theta N
/// a, c_u a) of q and u. 1 is the tolerance (or the rounding of a, 1e-14 |a|, where that is more).
///
/// - Full Newton (factor_kept_steps = 1): a fresh matrix at every iterate.
/// - Kept factor (factor_kept_steps = n > 1): the factor is used by the iterates of n steps. It is renewed
///   early where kappa > 1/2 or the coefficients of the matrix changed by more than a tenth. The equation of
///   the stage is the same: the solutions agree within the tolerance.
///
/// Where this fails (no convergence in 20 iterations, no descent, a trial that is not finite) the solve is
/// repeated once from the start configuration (theta = 0, where no element is worse than at the start of the
/// step), with fresh and projected tangents (System::project_to_psd), in 60 iterations.
class StageNewton : private NewtonEquation {
 public:
  StageNewton(dynamics::System& system, const IntegratorSpec& spec,
              std::unique_ptr<dynamics::LinearSolver> solver);

  /// Solves a stage.
  /// @param stage  coefficients and known parts
  /// @param from  start of the step: q0, u0, t0
  /// @param a  initial guess on entry, solution on return
  /// @param q1, u1  end of the stage, on the manifold, driven directions exact
  /// @param counters  receives the counts of this solve
  NewtonResult solve(const Stage& stage, const dynamics::StateView& from, VecX& a, VecX& q1, VecX& u1,
                     dynamics::StepperCounters& counters);

  /// Called after a step is accepted: the age of the factor increases.
  void step_done() { ++age_; }
  /// Discards the factor.
  void forget() { have_factor_ = false; }
  const StepSolver& solver() const { return solver_; }

 private:
  NewtonResult iterate(int limit, bool full);
  bool place(const VecX& a);
  bool evaluate(const VecX& a) override;
  bool solved() const override { return (residual_.array() == 0.0).all(); }
  dynamics::StateView at() const;
  bool usable() const;
  void assemble();
  dynamics::SolveStatus refresh() override;
  double norm(const VecX& d);
  bool correct(VecX& d, double& size) override;
  double rounding(const VecX& a) override { return 1e-14 * norm(a); }

  dynamics::System& system_;
  IntegratorSpec tolerance_;  ///< Settings of the weights, with newton_rtol in place of rtol.
  int kept_steps_;
  StepSolver solver_;
  dynamics::BorderedMatrix A_;
  bool have_factor_ = false;
  int age_ = 0;                                     ///< Number of steps that used the factor.
  double m_scale_ = 0, d_scale_ = 0, k_scale_ = 0;  ///< Coefficients of the factored matrix.
  DampedNewton newton_;

  // Arguments and scratch of the current solve.
  const Stage* stage_ = nullptr;
  const dynamics::StateView* from_ = nullptr;
  dynamics::StepperCounters* counters_ = nullptr;
  VecX *a_ = nullptr, *q1_ = nullptr, *u1_ = nullptr;
  VecX weights_, theta_, q_s_, u_s_, a_s_, residual_, dq_, scratch_;
};

}  // namespace palpate::integrate
