#pragma once
#include <utility>

#include "integrate/direct_fallback.h"
#include "palpate/dynamics/stepper.h"
#include "palpate/dynamics/system.h"

namespace palpate::integrate {

/// Projects the tangents of the system's terms to positive semi-definite ones during its lifetime.
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

/// Policy for the Newton matrices of an implicit step: actions where the chosen linear solver cannot solve
/// with a matrix.
///
/// - Unsymmetric, and the chosen solver supports symmetric ones only: an iteration preconditioned by its
///   factor of the symmetric part (DirectFallback); LU where that part is indefinite or the iteration does
///   not converge.
/// - Indefinite, and IntegratorSpec::indefinite is kProject: the matrix of projected tangents, by the chosen
///   solver. Where that one is indefinite as well: the true matrix, directly.
/// - Indefinite, and IntegratorSpec::indefinite is kLu: the true matrix, directly. With an inverted element
///   or a compressed strut it is still the right Newton matrix, but not one of a minimum: Newton's method may
///   converge to a saddle, and a large step may lead anywhere.
/// - The iteration does not converge, for a right-hand side or a column of the border: a Cholesky factor,
///   made at that point. Where there is none, the matrix is indefinite: as above.
///
/// "Directly" is Cholesky where such a factor exists, else LU (DirectFallback).
///
/// A factorisation detects an indefinite matrix before anything is solved. Conjugate gradients detect it
/// during the solve, if the right-hand side has a component along a direction of negative curvature, p . A p
/// <= 0. If it has none, neither has the solution, which then lowers b . A^-1 b / 2 as it would with a
/// definite matrix. A projected matrix changes the path of the iterates, but not an implicit equation that
/// Newton solves to its tolerance.
class StepSolver {
 public:
  StepSolver(std::unique_ptr<dynamics::LinearSolver> chosen, const IntegratorSpec& spec)
      : solvers_(std::move(chosen), spec), project_(spec.indefinite == IndefiniteTreatment::kProject) {}

  /// Factors A.
  /// @param reassemble  writes A again, from the system's current tangents
  template <class Reassemble>
  dynamics::SolveStatus factor(const dynamics::BorderedMatrix& A, dynamics::System& system,
                               Reassemble&& reassemble) {
    const dynamics::SolveStatus status = factor_chosen(A);
    if (status == dynamics::SolveStatus::kNotConverged) return factor_direct(A);
    if (status != dynamics::SolveStatus::kIndefinite) return status;
    // For an unsymmetric matrix the status concerns its symmetric part only.
    return project_ && A.symmetric ? factor_indefinite(A, system, reassemble) : factor_direct(A);
  }

  /// Factors a matrix that is known to be indefinite; A need not have been written yet.
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

  /// Solves with the matrix last factored.
  /// @param right_hand_side  returns b for the matrix that is factored at the call, projected or not
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

  /// Returns the chosen solver.
  dynamics::LinearSolver& chosen() { return solvers_.chosen(); }
  /// Returns whether IntegratorSpec::indefinite is kProject.
  bool projects() const { return project_; }
  /// Returns whether the matrix last factored has projected tangents, in place of an indefinite one.
  bool projected() const { return projected_; }
  /// Counts a matrix that its owner found to be indefinite, or whose step followed a direction of negative
  /// curvature.
  void count_indefinite() { ++indefinite_count_; }
  /// Counts a projected matrix that its owner solved with.
  void count_projected() { ++projected_count_; }
  /// Returns the sum over all solvers.
  const dynamics::SolverCounters& counters() const { return solvers_.counters(); }
  /// Writes all counts, including the counts of the solvers.
  void report(dynamics::StepperCounters& counters) const;

 private:
  dynamics::SolveStatus factor_chosen(const dynamics::BorderedMatrix& A);
  dynamics::SolveStatus factor_projected(const dynamics::BorderedMatrix& A);
  dynamics::SolveStatus factor_direct(const dynamics::BorderedMatrix& A);
  /// Solves by the chosen solver, or by a Cholesky factor where its iteration does not converge.
  dynamics::SolveStatus solve_symmetric(const VecX& b, VecX& x);

  DirectFallback solvers_;
  const dynamics::BorderedMatrix* matrix_ = nullptr;  ///< Matrix last factored.
  bool project_, projected_ = false;
  long indefinite_count_ = 0, projected_count_ = 0, unconverged_count_ = 0;
};

}  // namespace palpate::integrate
