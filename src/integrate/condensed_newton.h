#pragma once
#include "integrate/step_solver.h"
#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::integrate {

/// Newton's matrix I - gamma J of the first-order form y = [q; u], never assembled at that size.  With q' = N(q) u,
/// M u' = f, K = -df/dq N, D = -df/du, and theta the displacement along u-directions (dq = N theta), its two rows are
///     dq - gamma N du = r1                      (d(N u)/dq is left out: gamma times a rigid body's spin)
///     M du + gamma (K theta + D du) = M r2
/// With the left inverse N+ of N, theta = N+ r1 + gamma du, and so
///     (M + gamma D + gamma^2 K) du = M r2 - gamma K N+ r1,     dq = r1 + gamma N du.
/// On node blocks N is the identity.  Rows of driven directions give dq = r1, du = r2.
class CondensedNewton {
 public:
  CondensedNewton(dynamics::System& system, std::unique_ptr<dynamics::LinearSolver> solver) : system_(system), solver_(std::move(solver)) {}

  /// M, D and K at this state; no factor yet.
  void evaluate(const dynamics::StateView& state, dynamics::StepperCounters& counters);
  /// Factor of M + gamma D + gamma^2 K with the matrices last evaluated; nothing is done where gamma and they are unchanged.
  dynamics::SolveStatus factor(double gamma);
  /// Solves for (dq, du).  N is taken at q.  The outputs may not alias the residuals.
  dynamics::SolveStatus solve(const dynamics::Layout& layout, const double* q, const double* r1, const double* r2, double* dq, double* du);
  double gamma() const { return gamma_; }  ///< of the last factor; 0 when there is none
  const StepSolver& solver() const { return solver_; }

 private:
  void combine(double gamma);
  dynamics::System& system_;
  StepSolver solver_;
  dynamics::BorderedMatrix M_, D_, K_, A_;
  double gamma_ = 0.0;
  VecX theta_, rhs_, product_, du_;
};

}  // namespace palpate::integrate
