#pragma once
#include <utility>

#include "integrate/direct_fallback.h"
#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::integrate {

/// While it lives, the tangents of the system's terms are projected to positive semi-definite ones.
class ProjectedTangents {
 public:
  explicit ProjectedTangents(dynamics::System& system) : system_(system), before_(system.projects_to_psd()) {
    system_.project_to_psd(true);
  }
  ~ProjectedTangents() { system_.project_to_psd(before_); }
  ProjectedTangents(const ProjectedTangents&) = delete;
  ProjectedTangents& operator=(const ProjectedTangents&) = delete;

 private:
  dynamics::System& system_;
  bool before_;
};

/// The policy for the Newton matrices of an implicit step: what is done where the chosen linear solver cannot
/// solve with a matrix.
///
/// - Unsymmetric, and the chosen solver takes symmetric ones only: an iteration over its factor of the
///   symmetric part (DirectFallback); LU where that part is indefinite or the iteration does not converge.
/// - Indefinite, and IntegratorSpec::indefinite is "project": the matrix of projected tangents, by the chosen
///   solver.  Where that one is indefinite as well: the true matrix, directly.
/// - Indefinite, and IntegratorSpec::indefinite is "lu": the true matrix, directly.  With an inverted element
///   or a compressed strut it is still the right Newton matrix, but not that of a minimum: Newton may run to
///   a saddle, and a large step anywhere.
/// - The iteration does not converge, for a right-hand side or a column of the border: a Cholesky factor,
///   made then.  Where there is none, the matrix is indefinite: as above.
///
/// "Directly" is Cholesky where there is such a factor, else LU (DirectFallback).
///
/// A factor shows that a matrix is indefinite before anything is solved.  Conjugate gradients show it while
/// they solve, if the right-hand side has a part along a direction of negative curvature, p . A p <= 0; if it
/// has none, neither has the solution, which then lowers b . A^-1 b / 2 as one with a definite matrix does.
/// A projected matrix changes the way to the solution, never an implicit equation that Newton solves to its
/// tolerance.
class StepSolver {
 public:
  StepSolver(std::unique_ptr<dynamics::LinearSolver> chosen, const IntegratorSpec& spec)
      : solvers_(std::move(chosen), spec), project_(spec.indefinite == "project") {}

  /// Factors A.  @param reassemble  writes A again, by the tangents that the system then gives
  template <class Reassemble>
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A, dynamics::System& system,
                               Reassemble&& reassemble) {
    const dynamics::SolveStatus status = factor_chosen(A);
    if (status == dynamics::SolveStatus::kNotConverged) return factor_direct(A);
    if (status != dynamics::SolveStatus::kIndefinite) return status;
    // of an unsymmetric matrix that is said of its symmetric part alone
    return project_ && A.symmetric ? factor_indefinite(A, system, reassemble) : factor_direct(A);
  }

  /// Factors a matrix that is known to be indefinite, and need not have been written to A yet.
  template <class Reassemble>
  dynamics::SolveStatus factor_indefinite(const dynamics::BorderedMatrix& A, dynamics::System& system,
                                          Reassemble&& reassemble) {
    if (project_) {
      {
        const ProjectedTangents projected(system);
        reassemble();
      }
      if (factor_projected(A) == dynamics::SolveStatus::kOk) return dynamics::SolveStatus::kOk;
    }
    reassemble();
    return factor_direct(A);
  }

  /// Solves with the matrix last factored.  @param right_hand_side  gives b, for the matrix that is then
  ///   factored, projected or not
  template <class Reassemble, class RightHandSide>
  dynamics::SolveStatus solve(dynamics::System& system, Reassemble&& reassemble,
                              RightHandSide&& right_hand_side, VecX& x) {
    dynamics::SolveStatus status = solve_symmetric(right_hand_side(), x);
    if (status != dynamics::SolveStatus::kIndefinite) return status;
    const dynamics::BorderedMatrix& A = *matrix_;
    if (project_ && !projected_ && A.symmetric) {
      if (status = factor_indefinite(A, system, reassemble); status != dynamics::SolveStatus::kOk)
        return status;
      if (status = solve_symmetric(right_hand_side(), x); status != dynamics::SolveStatus::kIndefinite)
        return status;
    }
    if (projected_) reassemble();
    if (status = factor_direct(A); status != dynamics::SolveStatus::kOk) return status;
    return solvers_.solve(right_hand_side(), x);
  }

  dynamics::LinearSolver& chosen() { return solvers_.chosen(); }
  /// IntegratorSpec::indefinite = "project"
  bool projects() const { return project_; }
  /// Whether the matrix last factored is of projected tangents, in place of one that was indefinite.
  bool projected() const { return projected_; }
  /// Counts a matrix that its owner found out about itself: it was indefinite, or the step went along its
  /// negative curvature; its projection was solved with.
  void count_indefinite() { ++indefinite_count_; }
  void count_projected() { ++projected_count_; }
  /// Sum over the solvers.
  const dynamics::SolverCounters& counters() const { return solvers_.counters(); }
  /// Writes what it counted, the solvers' own counts included.
  void report(dynamics::StepperCounters& counters) const;

 private:
  dynamics::SolveStatus factor_chosen(const dynamics::BorderedMatrix& A);
  dynamics::SolveStatus factor_projected(const dynamics::BorderedMatrix& A);
  dynamics::SolveStatus factor_direct(const dynamics::BorderedMatrix& A);
  /// By the chosen solver, or by a Cholesky factor where its iteration does not converge.
  dynamics::SolveStatus solve_symmetric(const VecX& b, VecX& x);

  DirectFallback solvers_;
  const dynamics::BorderedMatrix* matrix_ = nullptr;  ///< last factored
  bool project_, projected_ = false;
  long indefinite_count_ = 0, projected_count_ = 0, unconverged_count_ = 0;
};

}  // namespace palpate::integrate
