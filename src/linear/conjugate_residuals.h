#pragma once
#include "linear/symmetric_part.h"
#include "palpate/dynamics/linear_solver.h"

namespace palpate::linear {

/// Unsymmetric matrices by a direct solver of symmetric ones (Concus and Golub 1976, Widlund 1978).
///     A = S + N,  S = (A + A^T)/2 positive definite,  N = (A - A^T)/2:      A S^-1 = I + N S^-1
/// In the inner product <a, b> = a . S^-1 b the operator K = N S^-1 is skew, since S^-1 N S^-1 is.  With
/// (I + K)^* = I - K = 2 I - (I + K) a new direction I + K is made orthogonal to all older ones by the last
/// alone, as in conjugate gradients: for older p_i
///     <(I + K) r, (I + K) p_i> = 2 <r, (I + K) p_i> - <r, (I + K)^2 p_i> = 0,
/// because a residual of least norm is orthogonal to (I + K) p_0, .. of all directions before.  So the
/// generalised conjugate residuals with one direction kept (Eisenstat, Elman and Schultz 1983) are GMRES in
/// that norm, with neither a basis nor restarts.  With the sum of S-energies <r, (I + K) r> = |r|^2 > 0 no
/// step is without progress, and
///     |r_k| <= 2 rho^k |b|,   rho = s / (1 + sqrt(1 + s^2)),   s = |K| the largest |x . N y| / |x|_S |y|_S,
/// however fine the mesh.  (What s is for contact with friction: gmres.h.)  A step takes a product with A and
/// a solution with S's factor.
///
/// The end: |b - A x| <= rtol |b|, both in the norm above.  Then, of the error e,
///     |e|_S^2 = e . A e = e . r <= |e|_S |r|,  |b| = |A x| <= (1 + s) |x|_S:     |e|_S <= rtol (1 + s)
///     |x|_S,
/// relative, in the energy norm, whatever units forces and moments have and without the condition of S.
///
/// What Newton asks of it.  SUNDIALS takes a direct solver's correction d for exact and estimates from the
/// norms of corrections how they contract; our test of convergence (adapter.cpp) never assumes a rate below
/// 0.05.  An error of rtol (1 + s) |d|_S adds that much to the rate in the energy norm, and in the weighted
/// norm of velocities, uniform as the mass is, at most sqrt(q) times as much, q = h^2 w^2 with w the highest
/// frequency.  With rtol = 1e-8 it stays below a fiftieth of 0.05 up to h w = 1e5.
///
/// A matrix that is symmetric to rounding (friction without contact) is solved with as S is.
///
/// kIndefinite: S has no Cholesky factor.  kNotConverged: after kLimit steps.  The counters are to be
/// added to those of the direct solver; solutions for the preconditioner are not counted as right-hand sides.
class ConjugateResiduals final : public dynamics::LinearSolver {
 public:
  /// @param symmetric  solves with S, exactly; its owner keeps it, and asks it for nothing between factor()
  ///   and the last solve with it
  ConjugateResiduals(double rtol, dynamics::LinearSolver& symmetric);
  std::string name() const override { return "conjugate residuals"; }
  bool supports_unsymmetric() const override { return true; }
  bool supports_indefinite() const override { return false; }
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A) override;
  dynamics::SolveStatus solve(const VecX& b, VecX& x) override;
  dynamics::SolveStatus solve(const MatX& B, MatX& X) override;
  const dynamics::SolverCounters& counters() const override { return counters_; }

 private:
  /// They reach 1e-8 up to s = 3.
  static constexpr int kLimit = 60;

  dynamics::SolveStatus precondition(const VecX& r, VecX& z);
  void multiply(const VecX& v, VecX& Av);
  dynamics::SolveStatus solve_column();
  dynamics::SolveStatus reduce_residual(double goal, int& left);

  /// A direction p, its image q = A p of norm 1, and t = S^-1 q.
  struct Direction {
    VecX p, q, t;
  };

  double rtol_;
  dynamics::LinearSolver& symmetric_;
  SymmetricPart part_;
  const dynamics::BorderedMatrix* matrix_ = nullptr;  ///< last given to factor()
  dynamics::SolveStatus status_ = dynamics::SolveStatus::kSingular;
  Direction last_, next_;
  VecX b_, x_, r_, z_;
  dynamics::SolverCounters counters_;
};

}  // namespace palpate::linear
