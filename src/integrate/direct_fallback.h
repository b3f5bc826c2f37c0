#pragma once
#include <memory>

#include "palpate/dynamics/linear_solver.h"

namespace palpate::integrate {

/// A chosen linear solver with others behind it, each made at the first matrix that needs it: for unsymmetric
/// matrices that it does not take, an iteration preconditioned by its factor of the symmetric part
/// (linear::make_unsymmetric_solver); Cholesky where the matrix has such a factor; LU where it has none.
/// Knows one matrix at a time and who solves with it; when to fall back is for its owner to say.
class DirectFallback {
 public:
  DirectFallback(std::unique_ptr<dynamics::LinearSolver> chosen, const IntegratorSpec& spec);

  dynamics::LinearSolver& chosen() { return *chosen_; }
  const dynamics::LinearSolver& chosen() const { return *chosen_; }
  /// Whether the matrix last factored is the chosen solver's, or the iteration's over it.
  bool by_chosen() const { return active_ == chosen_.get() || active_ == unsymmetric_.get(); }

  /// By the chosen solver, or the iteration over it.
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A);
  /// Without iterations: by Cholesky, at a third of LU's time, unless the chosen solver has just found that
  /// there is no such factor; else by LU.
  dynamics::SolveStatus factor_direct(const dynamics::BorderedMatrix& A);
  /// kIndefinite: a symmetric matrix has no Cholesky factor.
  dynamics::SolveStatus factor_by_cholesky(const dynamics::BorderedMatrix& A);
  /// Counted: "integrate.matrices_left_to_lu".
  dynamics::SolveStatus factor_by_lu(const dynamics::BorderedMatrix& A);

  template <class Columns>
  dynamics::SolveStatus solve(const Columns& b, Columns& x) {
    return active_->solve(b, x);
  }
  long left_to_lu() const { return left_to_lu_; }
  /// Sum over all solvers.
  const dynamics::SolverCounters& counters() const;

 private:
  IntegratorSpec spec_;
  std::unique_ptr<dynamics::LinearSolver> chosen_, unsymmetric_, cholesky_, lu_;
  dynamics::LinearSolver* active_;
  long left_to_lu_ = 0;
  mutable dynamics::SolverCounters sum_;
};

}  // namespace palpate::integrate
