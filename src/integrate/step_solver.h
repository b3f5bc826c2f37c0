#pragma once
#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::integrate {

/// While it lives, the system's terms give positive semi-definite tangents.
class DefiniteTangents {
 public:
  explicit DefiniteTangents(dynamics::System& system) : system_(system) { system_.set_definite(true); }
  ~DefiniteTangents() { system_.set_definite(false); }
  DefiniteTangents(const DefiniteTangents&) = delete;
  DefiniteTangents& operator=(const DefiniteTangents&) = delete;

 private:
  dynamics::System& system_;
};

/// The linear solver of an integrator, with what stands behind it: an LU, made at the first matrix that the chosen solver cannot take.
///   unsymmetric                         LU ("integrate.unsymmetric" is counted)
///   indefinite, IntegratorSpec::        the matrix of definite tangents by the chosen solver; where that is indefinite too, LU of the true one
///     indefinite = "project"
///   indefinite, "lu"                    LU: of an inverted element or a compressed strut it is still the right Newton matrix,
///                                       but no minimum's: Newton may run to a saddle, a large step to nowhere
///   an iteration that does not end      LU, when a right-hand side asks for it
/// A projected matrix changes the way to the solution, never an implicit equation that Newton solves to its tolerance.
class StepSolver final : public dynamics::LinearSolver {
 public:
  StepSolver(std::unique_ptr<dynamics::LinearSolver> chosen, const IntegratorSpec& spec);

  std::string name() const override { return chosen_->name(); }
  bool supports_unsymmetric() const override { return true; }
  /// With LU behind the chosen solver: for whom there are no definite tangents to ask for.
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A) override;
  dynamics::SolveStatus solve(const MatX& B, MatX& X) override { return solve_any(B, X); }
  dynamics::SolveStatus solve(const VecX& b, VecX& x) override { return solve_any(b, x); }
  /// Of the chosen solver alone: what it cannot do with a balanced matrix, it says, and wants the whole one, with which the policy above begins.
  dynamics::BalancedMatrix* balanced(const dynamics::BlockSparse& pattern) override { return chosen_->balanced(pattern); }
  dynamics::SolveStatus factor_balanced() override;
  dynamics::SolveStatus solve_near(dynamics::Residual& left, VecX& x) override {
    return matrix_ ? dynamics::SolveStatus::kNotConverged : chosen_->solve_near(left, x);
  }
  /// Sum over both solvers.
  const dynamics::SolverCounters& counters() const override;

  /// The policy above.  @param reassemble  writes A again, by the tangents that the system then gives
  template <class Reassemble>
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A, dynamics::System& system, Reassemble&& reassemble) {
    dynamics::SolveStatus status = factor_chosen(A);
    if (status != dynamics::SolveStatus::kIndefinite) return status;
    if (project_) {
      {
        const DefiniteTangents definite(system);
        reassemble();
      }
      status = chosen_->factor(A);
      if (status == dynamics::SolveStatus::kOk) {
        ++projected_;
        return status;
      }
      reassemble();
    }
    return factor_by_lu(A);
  }

  /// Writes what it counted, the solvers' own counts included.
  void report(dynamics::StepperCounters& counters) const;

 private:
  dynamics::SolveStatus factor_chosen(const dynamics::BorderedMatrix& A);
  dynamics::SolveStatus factor_by_lu(const dynamics::BorderedMatrix& A);
  template <class Columns>
  dynamics::SolveStatus solve_any(const Columns& b, Columns& x);

  std::unique_ptr<dynamics::LinearSolver> chosen_, lu_;
  dynamics::LinearSolver* active_;
  const dynamics::BorderedMatrix* matrix_ = nullptr;  ///< last factored; null: a balanced one
  bool project_;
  long indefinite_ = 0, projected_ = 0, unconverged_ = 0;
  MatX kept_columns_;  ///< right-hand sides of a solve in place, in case it has to be done again
  VecX kept_column_;
  mutable dynamics::SolverCounters sum_;
};

}  // namespace palpate::integrate
