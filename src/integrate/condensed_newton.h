#pragma once
#include "dynamics/energy_tolerance.h"
#include "integrate/step_solver.h"

namespace palpate::integrate {

/// Newton's matrix I - gamma J of the first-order form y = [q; u], never assembled at that size. With q' =
/// N(q) u, M u' = f, K = -df/dq N, D = -df/du, and theta the displacement along u-directions (dq = N theta),
/// its two rows are
///     dq - gamma N du = r1                      (d(N u)/dq is left out: gamma times a rigid body's spin)
///     M du + gamma (K theta + D du) = M r2
/// With the left inverse N+ of N, theta = N+ r1 + gamma du, and so
///     (M + gamma D + gamma^2 K) du = M r2 - gamma K N+ r1,     dq = r1 + gamma N du.
/// On node blocks N is the identity. Rows of driven directions give dq = r1, du = r2.
///
/// The residual form F(y, y') = [q' - N u; M u' - f] with J = dF/dy + (1/gamma) dF/dy' has the rows
///     dq / gamma - N du = r1,     K theta + (D + M / gamma) du = r2      [r2 in N, N m]
/// and therefore the same matrix, without a mass in the right-hand side:
///     (M + gamma D + gamma^2 K) du = gamma r2 - gamma^2 K N+ r1,     dq = gamma (r1 + N du).
/// Rows of driven directions (q' = 0, u' = 0) give dq = gamma r1, du = gamma r2.
///
/// An indefinite matrix is handled as described for StepSolver. Under kProject M, D and K are evaluated
/// again with definite tangents, which are used until the next evaluate().
class CondensedNewton {
 public:
  CondensedNewton(dynamics::System& system, std::unique_ptr<dynamics::LinearSolver> solver,
                  const IntegratorSpec& spec)
      : system_(system),
        solver_(std::move(solver), spec),
        tolerance_(dynamic_cast<dynamics::EnergyTolerance*>(&solver_.chosen())) {}

  /// Evaluates M, and D and K of the terms selected by `filter` (empty: all), at this state, without a
  /// factorisation.
  /// @param counters  also counts evaluations triggered later by factor() and the solves; must outlive them
  void evaluate(const dynamics::StateView& state, dynamics::StepperCounters& counters,
                const dynamics::System::TermFilter& filter = {});
  /// Factors M + gamma D + gamma^2 K with the matrices last evaluated. Does nothing where gamma and the
  /// matrices are unchanged.
  dynamics::SolveStatus factor(double gamma);
  /// Solves for (dq, du) in first-order form. N is evaluated at q. The outputs must not alias the residuals.
  /// @param nodes_only  q' = N u of blocks with kinematics is not part of the system to be solved: dq = r1
  ///   there
  dynamics::SolveStatus solve(const dynamics::Layout& layout, const double* q, const double* r1,
                              const double* r2, double* dq, double* du, bool nodes_only = false);
  /// Solves for (dq, du) in residual form.
  dynamics::SolveStatus solve_residual_form(const dynamics::Layout& layout, const double* q, const double* r1,
                                            const double* r2, double* dq, double* du);
  double gamma() const { return gamma_; }  ///< Returns gamma of the last factor; 0 when there is none.
  /// Returns whether the linear solver supports limit_error().
  bool takes_error_limit() const { return tolerance_ != nullptr; }
  /// Allows solutions an error of `error` in the norm sqrt(mean (w_i e_i)^2) of the first-order form: e_u =
  /// e, e_q = gamma e.
  /// @param w  weights of q, then of u
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
  const dynamics::Layout* layout_ = nullptr;  ///< State of the last evaluation: layout, time, q and u.
  double time_ = 0.0;
  VecX q_, u_;
  dynamics::System::TermFilter filter_;
  dynamics::BorderedMatrix M_, D_, K_, A_;
  double gamma_ = 0.0;
  VecX theta_, free_r2_, rhs_, product_, du_;
};

}  // namespace palpate::integrate
