#pragma once
#include <memory>
#include <string>

#include "palpate/core/registry.h"
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/spec.h"

namespace palpate::dynamics {

enum class SolveStatus { kOk, kIndefinite, kSingular, kNotConverged };

struct SolverCounters {
  long symbolic = 0;  ///< symbolic analyses (once a pattern)
  /// of them, those that looked for a fill-reducing ordering, where the solver keeps one from pattern to
  /// pattern
  long orderings = 0;
  long factorisations = 0;  ///< numeric factorisations
  long solves = 0;          ///< right-hand sides
  long iterations = 0;      ///< of iterative methods
  long near = 0;            ///< of the right-hand sides, those solved by the matrix of an earlier one
  long residuals = 0;       ///< that these looked at
  long refreshes = 0;       ///< coarse spaces made anew, where a method has one that it keeps
  double symbolic_s = 0.0, factor_s = 0.0, solve_s = 0.0;  ///< wall time [s]
  /// fill-reducing ordering of the last analysis, where the solver chooses: "AMD", "METIS"
  std::string ordering;

  /// What another solver counted is added; the ordering stays this one's own.
  SolverCounters& operator+=(const SolverCounters& other) {
    symbolic += other.symbolic;
    orderings += other.orderings;
    factorisations += other.factorisations;
    solves += other.solves;
    iterations += other.iterations;
    near += other.near;
    residuals += other.residuals;
    refreshes += other.refreshes;
    symbolic_s += other.symbolic_s;
    factor_s += other.factor_s;
    solve_s += other.solve_s;
    return *this;
  }
};

/// Solves A X = B for a bordered matrix.  Symbolic analysis once per pattern version; numeric work only when
/// the values' version changed.  What only some solvers can do is a capability that a solver derives from
/// beside this class: mixed_precision_step.h.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  virtual std::string name() const = 0;
  virtual bool supports_unsymmetric() const = 0;
  /// Prepares for A; cheap when neither its pattern nor its values changed.  kIndefinite: a Cholesky factor
  /// does not exist. A stays where it is, unchanged, until the last solve with it: an iterative method reads
  /// it there.
  virtual SolveStatus factor(const BorderedMatrix& A) = 0;
  /// X = A^-1 B for the matrix last factored; B and X are size x nrhs, may be the same object.
  virtual SolveStatus solve(const MatX& B, MatX& X) = 0;
  virtual SolveStatus solve(const VecX& b, VecX& x) = 0;
  virtual const SolverCounters& counters() const = 0;
};

using MakeLinearSolver = std::unique_ptr<LinearSolver> (*)(const IntegratorSpec&);
using LinearSolverRegistry = Registry<MakeLinearSolver>;

}  // namespace palpate::dynamics
