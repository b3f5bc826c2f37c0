#pragma once
#include "integrate/direct_fallback.h"

namespace palpate::integrate {

/// Linear solver for every matrix that has an inverse. Where the chosen solver, or the iteration that uses it
/// for unsymmetric matrices, fails, the matrix is solved directly.
class RobustSolver final : public dynamics::LinearSolver {
 public:
  RobustSolver(std::unique_ptr<dynamics::LinearSolver> chosen, const IntegratorSpec& spec)
      : solvers_(std::move(chosen), spec) {}

  std::string name() const override { return solvers_.chosen().name(); }
  bool supports_unsymmetric() const override { return true; }
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A) override;
  dynamics::SolveStatus solve(const MatX& B, MatX& X) override { return solve_columns(B, X, kept_columns_); }
  dynamics::SolveStatus solve(const VecX& b, VecX& x) override { return solve_columns(b, x, kept_column_); }
  const dynamics::SolverCounters& counters() const override { return solvers_.counters(); }

 private:
  template <class Columns>
  dynamics::SolveStatus solve_columns(const Columns& b, Columns& x, Columns& kept);

  DirectFallback solvers_;
  const dynamics::BorderedMatrix* matrix_ = nullptr;  ///< Matrix last factored.
  /// Right-hand sides of a solve in place, in case it has to be repeated.
  MatX kept_columns_;
  VecX kept_column_;
};

}  // namespace palpate::integrate
