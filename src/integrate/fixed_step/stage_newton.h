#pragma once
#include "integrate/newton.h"
#include "integrate/step_solver.h"
#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::integrate {

/// One implicit stage of a mechanical method, in the unknown a (an acceleration, along u-directions):
///     end       u1 = u + c_u a,   theta = theta + c_theta a,   q1 = q0 (+) theta          (displace.h),
///     driven directions at time t1
///     stage     q_s = w q1 + (1 - w) q0,  u_s = w u1 + (1 - w) u0,  t_s = w t1 + (1 - w) t0
///     equation  M(q_s) (a_c + c_a a) = f(q_s, u_s, t_s)                                    on free
///     directions
/// Newton's matrix is c_a M + w c_u D + w c_theta K, symmetric where the system is.  (The derivative of M and
/// of the map (+) beyond first order, both of rigid bodies, are left out.)  Driven directions enter the stage
/// as the means of their values at the ends, like all others, so a body that moves rigidly with its drive
/// feels no force at any step; they leave the unknowns (System::residual, step_matrix).
struct Stage {
  double t1 = 0.0, weight = 1.0;  ///< w
  double c_u = 0.0, c_theta = 0.0, c_a = 1.0;
  VecX u, theta, a_c;  ///< the known parts; an empty a_c is zero
};

/// Newton's method (integrate/newton.h) for a Stage.
/// |.| is the weighted norm of error_weights with newton_rtol for rtol, of the increments (c_theta N a, c_u
/// a) of q and u: 1 is the tolerance
/// (or rounding of a, 1e-14 |a|, where that is more).
///   full Newton (factor_kept_steps = 1): a fresh matrix at every iterate.
///   kept factor (n > 1): the factor serves the iterates of n steps, and is renewed early where kappa > 1/2
///   or the coefficients
///   of the matrix changed by more than a tenth.  The stage's equation is the same: the answers agree within
///   the tolerance.
/// Where this fails (no convergence in 20 iterations, no descent, a trial that is not finite) it is tried
/// once more from the start configuration (theta = 0: no element is worse there than it was), fresh and with
/// projected tangents (System::project_to_psd), in 60 iterations.
class StageNewton : private NewtonEquation {
 public:
  StageNewton(dynamics::System& system, const IntegratorSpec& spec,
              std::unique_ptr<dynamics::LinearSolver> solver);

  /// @param from  the start of the step: q0, u0, t0   @param a  first guess in, solution out
  /// @param q1, u1  the end of the stage, on the manifold, driven directions exact
  NewtonResult solve(const Stage& stage, const dynamics::StateView& from, VecX& a, VecX& q1, VecX& u1,
                     dynamics::StepperCounters& counters);

  /// A step is done: the factor is a step older.
  void step_done() { ++age_; }
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
  IntegratorSpec tolerance_;  ///< with newton_rtol for rtol
  int kept_steps_;
  StepSolver solver_;
  dynamics::BorderedMatrix A_;
  bool have_factor_ = false;
  int age_ = 0;                                     ///< steps that the factor has served
  double m_scale_ = 0, d_scale_ = 0, k_scale_ = 0;  ///< of the factored matrix
  DampedNewton newton_;

  // of the solve under way
  const Stage* stage_ = nullptr;
  const dynamics::StateView* from_ = nullptr;
  dynamics::StepperCounters* counters_ = nullptr;
  VecX *a_ = nullptr, *q1_ = nullptr, *u1_ = nullptr;
  VecX weights_, theta_, q_s_, u_s_, a_s_, residual_, dq_, scratch_;
};

}  // namespace palpate::integrate
