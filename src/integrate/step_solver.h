#pragma once
#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::integrate {

/// While it lives, the system's terms give positive semi-definite tangents.
class DefiniteTangents {
 public:
  explicit DefiniteTangents(dynamics::System& system) : system_(system), before_(system.definite()) {
    system_.set_definite(true);
  }
  ~DefiniteTangents() { system_.set_definite(before_); }
  DefiniteTangents(const DefiniteTangents&) = delete;
  DefiniteTangents& operator=(const DefiniteTangents&) = delete;

 private:
  dynamics::System& system_;
  bool before_;
};

/// The linear solver of an integrator, with what stands behind it, made at the first matrix that the chosen
/// solver cannot take.
///   unsymmetric                         LU ("integrate.unsymmetric" is counted)
///   indefinite, IntegratorSpec::        the matrix of definite tangents by the chosen solver; where that is
///   indefinite too, LU of the true one
///     indefinite = "project"
///   indefinite, "lu"                    LU: of an inverted element or a compressed strut it is still the
///   right Newton matrix,
///                                       but no minimum's: Newton may run to a saddle, a large step to
///                                       nowhere
///   an iteration that does not end      a Cholesky factor, when a right-hand side asks for it; where there
///   is none, the matrix is indefinite: as above
/// A factor shows that a matrix is indefinite before anything is solved.  Conjugate gradients show it while
/// they solve, if the right-hand side has a part along a direction of negative curvature, p . A p <= 0; if it
/// has none, neither has the solution, which then lowers b . A^-1 b / 2 as one with a definite matrix does.
/// A projected matrix changes the way to the solution, never an implicit equation that Newton solves to its
/// tolerance.
class StepSolver final : public dynamics::LinearSolver {
 public:
  StepSolver(std::unique_ptr<dynamics::LinearSolver> chosen, const IntegratorSpec& spec);

  std::string name() const override { return chosen_->name(); }
  bool supports_unsymmetric() const override { return true; }
  /// The policy "lu": for whom there are no definite tangents to ask for.
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A) override;
  dynamics::SolveStatus solve(const MatX& B, MatX& X) override { return solve_any(B, X); }
  dynamics::SolveStatus solve(const VecX& b, VecX& x) override { return solve_any(b, x); }
  /// Of the chosen solver alone: what it cannot do with a balanced matrix, it says, and wants the whole one,
  /// with which the policy above begins.
  dynamics::BalancedMatrix* balanced(const dynamics::BlockSparse& pattern) override {
    return chosen_->balanced(pattern);
  }
  dynamics::SolveStatus factor_balanced() override;
  /// factor_balanced() of definite tangents, in place of those of a matrix that was seen to be indefinite.
  dynamics::SolveStatus factor_balanced_definite();
  dynamics::SolveStatus solve_near(dynamics::Residual& left, VecX& x) override {
    return matrix_ ? dynamics::SolveStatus::kNotConverged : chosen_->solve_near(left, x);
  }
  /// Sum over all solvers.
  const dynamics::SolverCounters& counters() const override;

  /// The policy above.  @param reassemble  writes A again, by the tangents that the system then gives
  template <class Reassemble>
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A, dynamics::System& system,
                               Reassemble&& reassemble) {
    const dynamics::SolveStatus status = factor_chosen(A);
    if (status != dynamics::SolveStatus::kIndefinite) return status;
    return project_ ? factor_indefinite(A, system, reassemble) : factor_direct(A);
  }

  /// The policy for a matrix that was seen to be indefinite, and need not stand in A.
  template <class Reassemble>
  dynamics::SolveStatus factor_indefinite(const dynamics::BorderedMatrix& A, dynamics::System& system,
                                          Reassemble&& reassemble) {
    if (!matrix_ && !definite_) ++indefinite_;  // a balanced one
    if (project_) {
      {
        const DefiniteTangents definite(system);
        reassemble();
      }
      if (factor_definite(A) == dynamics::SolveStatus::kOk) return dynamics::SolveStatus::kOk;
    }
    reassemble();
    return factor_direct(A);
  }

  /// Solves with the matrix last factored, by the policy above.  @param right_hand_side  gives b, for the
  /// matrix that then stands
  template <class Reassemble, class RightHandSide>
  dynamics::SolveStatus solve(dynamics::System& system, Reassemble&& reassemble,
                              RightHandSide&& right_hand_side, VecX& x) {
    dynamics::SolveStatus status = solve_symmetric(right_hand_side(), x);
    if (status != dynamics::SolveStatus::kIndefinite || !matrix_) return status;
    const dynamics::BorderedMatrix& A = *matrix_;
    if (project_ && !definite_) {
      if (status = factor_indefinite(A, system, reassemble); status != dynamics::SolveStatus::kOk)
        return status;
      if (status = solve_symmetric(right_hand_side(), x); status != dynamics::SolveStatus::kIndefinite)
        return status;
    }
    if (definite_) reassemble();
    if (status = factor_direct(A); status != dynamics::SolveStatus::kOk) return status;
    return active_->solve(right_hand_side(), x);
  }

  /// IntegratorSpec::indefinite = "project"
  bool projects() const { return project_; }
  /// Whether the matrix that stands is of definite tangents, in place of one that was indefinite.
  bool definite() const { return definite_; }
  /// Writes what it counted, the solvers' own counts included.
  void report(dynamics::StepperCounters& counters) const;

 private:
  dynamics::SolveStatus factor_chosen(const dynamics::BorderedMatrix& A);
  dynamics::SolveStatus factor_definite(const dynamics::BorderedMatrix& A);
  dynamics::SolveStatus factor_by_cholesky(const dynamics::BorderedMatrix& A);
  dynamics::SolveStatus factor_direct(const dynamics::BorderedMatrix& A);
  dynamics::SolveStatus factor_by_lu(const dynamics::BorderedMatrix& A);
  /// By the chosen solver, or by a Cholesky factor where that does not end.
  dynamics::SolveStatus solve_symmetric(const VecX& b, VecX& x);
  template <class Columns>
  dynamics::SolveStatus solve_any(const Columns& b, Columns& x);

  std::unique_ptr<dynamics::LinearSolver> chosen_, cholesky_, lu_;
  dynamics::LinearSolver* active_;
  const dynamics::BorderedMatrix* matrix_ = nullptr;  ///< last factored; null: a balanced one
  /// definite_: the matrix last factored is of definite tangents
  bool project_, definite_ = false;
  long indefinite_ = 0, projected_ = 0, unconverged_ = 0;
  MatX kept_columns_;  ///< right-hand sides of a solve in place, in case it has to be done again
  VecX kept_column_;
  mutable dynamics::SolverCounters sum_;
};

}  // namespace palpate::integrate
