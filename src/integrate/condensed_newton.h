#pragma once
#include "integrate/step_solver.h"
#include "palpate/dynamics/energy_tolerance.h"

namespace palpate::integrate {

/// Newton's matrix I - gamma J of the first-order form y = [q; u], never assembled at that size.  With q' =
/// N(q) u, M u' = f, K = -df/dq N, D = -df/du, and theta the displacement along u-directions (dq = N theta),
/// its two rows are
///     dq - gamma N du = r1                      (d(N u)/dq is left out: gamma times a rigid body's spin)
///     M du + gamma (K theta + D du) = M r2
/// With the left inverse N+ of N, theta = N+ r1 + gamma du, and so
///     (M + gamma D + gamma^2 K) du = M r2 - gamma K N+ r1,     dq = r1 + gamma N du.
/// On node blocks N is the identity.  Rows of driven directions give dq = r1, du = r2.
///
/// The residual form F(y, y') = [q' - N u; M u' - f] with J = dF/dy + (1/gamma) dF/dy' has the rows
///     dq / gamma - N du = r1,     K theta + (D + M / gamma) du = r2      [r2 in N, N m]
/// and therefore the same matrix, with no mass in the right-hand side:
///     (M + gamma D + gamma^2 K) du = gamma r2 - gamma^2 K N+ r1,     dq = gamma (r1 + N du).
/// Rows of driven directions (q' - v(t), u' - a(t)) give dq = gamma r1, du = gamma r2.
///
/// An indefinite matrix is met as StepSolver says; "project" evaluates M, D and K again with definite
/// tangents, and those serve until the next evaluate().
class CondensedNewton {
 public:
  CondensedNewton(dynamics::System& system, std::unique_ptr<dynamics::LinearSolver> solver,
                  const IntegratorSpec& spec)
      : system_(system),
        solver_(std::move(solver), spec),
        tolerance_(dynamic_cast<dynamics::EnergyTolerance*>(&solver_.chosen())) {}

  /// M, and D and K of the terms that `filter` picks (empty: all), at this state; no factor yet.
  /// The counters are kept in mind for evaluations that factor() and the solves ask for: they outlive it.
  void evaluate(const dynamics::StateView& state, dynamics::StepperCounters& counters,
                const dynamics::System::TermFilter& filter = {});
  /// Factor of M + gamma D + gamma^2 K with the matrices last evaluated; nothing is done where gamma and they
  /// are unchanged.
  dynamics::SolveStatus factor(double gamma);
  /// Solves for (dq, du), first-order form.  N is taken at q.  The outputs may not alias the residuals.
  /// @param nodes_only  q' = N u of blocks with kinematics is not part of the system that is solved: dq =
  ///   r1 there
  dynamics::SolveStatus solve(const dynamics::Layout& layout, const double* q, const double* r1,
                              const double* r2, double* dq, double* du, bool nodes_only = false);
  /// Solves for (dq, du), residual form.
  dynamics::SolveStatus solve_residual_form(const dynamics::Layout& layout, const double* q, const double* r1,
                                            const double* r2, double* dq, double* du);
  double gamma() const { return gamma_; }  ///< of the last factor; 0 when there is none
  /// Whether the linear solver can use limit_error().
  bool takes_error_limit() const { return tolerance_ != nullptr; }
  /// Solutions may err by `error` in the norm sqrt(mean (w_i e_i)^2) of first-order form: e_u = e, e_q =
  /// gamma e.  @param w  of q and u, one after the other
  void limit_error(const dynamics::Layout& layout, const double* w, double error);
  const StepSolver& solver() const { return solver_; }

 private:
  void evaluate_matrices();
  void combine(double gamma);
  template <class RightHandSide>
  dynamics::SolveStatus solve_for(RightHandSide&& right_hand_side);
  void left_inverse(const dynamics::Layout& layout, const double* q, const double* r1, bool nodes_only);
  dynamics::System& system_;
  StepSolver solver_;
  dynamics::EnergyTolerance* tolerance_;
  dynamics::StepperCounters* counters_ = nullptr;
  const dynamics::Layout* layout_ = nullptr;  ///< of the last evaluation, with its time, q and u
  double time_ = 0.0;
  VecX q_, u_;
  dynamics::System::TermFilter filter_;
  dynamics::BorderedMatrix M_, D_, K_, A_;
  double gamma_ = 0.0;
  VecX theta_, free_r2_, rhs_, product_, du_;
};

}  // namespace palpate::integrate
