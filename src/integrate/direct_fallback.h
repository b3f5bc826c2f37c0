#pragma once
#include <memory>

#include "palpate/dynamics/linear_solver.h"

namespace palpate::integrate {

/// A chosen linear solver with direct ones behind it, each made at the first matrix that needs it: Cholesky
/// where the matrix has such a factor, LU where it has none.  Knows one matrix at a time and who solves with
/// it; when to fall back is for its owner to say.
class DirectFallback {
 public:
  explicit DirectFallback(std::unique_ptr<dynamics::LinearSolver> chosen);

  dynamics::LinearSolver& chosen() { return *chosen_; }
  const dynamics::LinearSolver& chosen() const { return *chosen_; }
  /// Whether the matrix last factored is the chosen solver's.
  bool by_chosen() const { return active_ == chosen_.get(); }

  /// By the chosen solver; an unsymmetric matrix that it does not take by LU ("integrate.unsymmetric" is
  /// counted).
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A);
  /// Without iterations: by Cholesky, at a third of LU's time, unless the chosen solver has just found that
  /// there is no such factor; else by LU.
  dynamics::SolveStatus factor_direct(const dynamics::BorderedMatrix& A);
  /// kIndefinite: a symmetric matrix has no Cholesky factor.
  dynamics::SolveStatus factor_by_cholesky(const dynamics::BorderedMatrix& A);
  dynamics::SolveStatus factor_by_lu(const dynamics::BorderedMatrix& A);

  template <class Columns>
  dynamics::SolveStatus solve(const Columns& b, Columns& x) {
    return active_->solve(b, x);
  }
  /// Sum over all solvers.
  const dynamics::SolverCounters& counters() const;

 private:
  std::unique_ptr<dynamics::LinearSolver> chosen_, cholesky_, lu_;
  dynamics::LinearSolver* active_;
  mutable dynamics::SolverCounters sum_;
};

}  // namespace palpate::integrate
