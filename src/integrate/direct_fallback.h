#pragma once
#include <memory>

#include "palpate/dynamics/linear_solver.h"

namespace palpate::integrate {

/// A linear solver chosen by the user, with three fallbacks that are made at the first matrix that needs
/// them. For unsymmetric matrices that the chosen solver does not support: an iteration preconditioned by its
/// factor of the symmetric part (linear::make_unsymmetric_solver). Cholesky, where the matrix has such a
/// factor. LU otherwise.
/// The object holds one matrix at a time and the solver in use; its owner decides when to fall back.
class DirectFallback {
 public:
  DirectFallback(std::unique_ptr<dynamics::LinearSolver> chosen, const IntegratorSpec& spec);

  dynamics::LinearSolver& chosen() { return *chosen_; }
  const dynamics::LinearSolver& chosen() const { return *chosen_; }
  /// Returns whether the matrix last factored was factored by the chosen solver, or by the iteration that
  /// uses it.
  bool by_chosen() const { return active_ == chosen_.get() || active_ == unsymmetric_.get(); }

  /// Factors A by the chosen solver, or prepares the iteration that uses it.
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A);
  /// Factors A directly: by Cholesky, at a third of LU's time, where A is symmetric and the chosen solver is
  /// not "cholmod" (whose factorisation has normally failed already); else by LU.
  dynamics::SolveStatus factor_direct(const dynamics::BorderedMatrix& A);
  /// Factors A by Cholesky. Returns kIndefinite where a symmetric matrix has no such factor.
  dynamics::SolveStatus factor_by_cholesky(const dynamics::BorderedMatrix& A);
  /// Factors A by LU. Counted as "integrate.matrices_left_to_lu".
  dynamics::SolveStatus factor_by_lu(const dynamics::BorderedMatrix& A);

  template <class Columns>
  dynamics::SolveStatus solve(const Columns& b, Columns& x) {
    return active_->solve(b, x);
  }
  long left_to_lu() const { return left_to_lu_; }
  /// Returns the sum over all solvers.
  const dynamics::SolverCounters& counters() const;

 private:
  IntegratorSpec spec_;
  std::unique_ptr<dynamics::LinearSolver> chosen_, unsymmetric_, cholesky_, lu_;
  dynamics::LinearSolver* active_;
  long left_to_lu_ = 0;
  mutable dynamics::SolverCounters sum_;
};

}  // namespace palpate::integrate
