#pragma once
#include <concepts>
#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>

#include "palpate/core/registry.h"
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/spec.h"

namespace palpate::dynamics {

/// Outcome of a factorisation or a solve: done; no Cholesky factor; no inverse; the iteration gave up.
enum class SolveStatus { kOk, kIndefinite, kSingular, kNotConverged };

/// What a linear solver did since it was made.
struct SolverCounters {
  long symbolic = 0;  ///< symbolic analyses (once a pattern)
  /// of them, those that looked for a fill-reducing ordering, where the solver keeps one from pattern to
  /// pattern
  long orderings = 0;
  long factorisations = 0;   ///< numeric factorisations
  long solves = 0;           ///< right-hand sides
  long iterations = 0;       ///< of iterative methods
  long lagged = 0;           ///< right-hand sides solved by refinement with the matrix of an earlier one
  long residual_checks = 0;  ///< residuals evaluated for these
  long refreshes = 0;        ///< coarse spaces made anew, where a method has one that it keeps
  double symbolic_s = 0.0, factor_s = 0.0, solve_s = 0.0;  ///< wall time [s]
  /// fill-reducing ordering of the last analysis, where the solver chooses: "AMD", "METIS"
  std::string ordering;

  /// What another solver counted is added; the ordering stays this one's own.
  SolverCounters& operator+=(const SolverCounters& other);
};

/// Calls f(name, members...) for every number of these counters, all of the same member of each; the type
/// tells the unit: long counts, double is wall time [s].  The names are those of summary.json, of a study's
/// database and of compare.csv.
template <class F, class... Counters>
requires(std::same_as<std::remove_const_t<Counters>, SolverCounters>&&...) constexpr void visit_counters(
    F&& f, Counters&... c) {
  f("symbolic_analyses", c.symbolic...);
  f("orderings", c.orderings...);
  f("factorisations", c.factorisations...);
  f("linear_solves", c.solves...);
  f("linear_iterations", c.iterations...);
  f("lagged_matrix_solves", c.lagged...);
  f("lagged_matrix_residual_checks", c.residual_checks...);
  f("coarse_space_refreshes", c.refreshes...);
  f("symbolic_s", c.symbolic_s...);
  f("factor_s", c.factor_s...);
  f("solve_s", c.solve_s...);
}

/// Bytes of the numbers that visit_counters() visits: with those of what is no number they are the struct's.
template <class Counters>
constexpr std::size_t bytes_of_counters() {
  std::size_t bytes = 0;
  const Counters zero;
  visit_counters([&bytes](const char*, const auto& value) { bytes += sizeof value; }, zero);
  return bytes;
}
static_assert(bytes_of_counters<SolverCounters>() + sizeof(std::string) == sizeof(SolverCounters),
              "visit_counters() leaves out a member of SolverCounters");

inline SolverCounters& SolverCounters::operator+=(const SolverCounters& other) {
  visit_counters([](const char*, auto& mine, const auto& theirs) { mine += theirs; }, *this, other);
  return *this;
}

/// Solves A X = B for a bordered matrix.  Symbolic analysis once per pattern version; numeric work only when
/// the values' version changed.  What only some solvers can do is a capability that a solver derives from
/// beside this class: mixed_precision_step.h.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  /// As scenes call it.
  virtual std::string name() const = 0;
  /// Whether it takes matrices that are not symmetric.
  virtual bool supports_unsymmetric() const = 0;
  /// Whether it takes matrices that are not positive definite, or whose symmetric part is not.
  virtual bool supports_indefinite() const { return supports_unsymmetric(); }
  /// Prepares for A; cheap when neither its pattern nor its values changed.  kIndefinite: a Cholesky factor
  /// does not exist. A stays where it is, unchanged, until the last solve with it: an iterative method reads
  /// it there.
  virtual SolveStatus factor(const BorderedMatrix& A) = 0;
  /// X = A^-1 B for the matrix last factored; B and X are size x nrhs, may be the same object.
  virtual SolveStatus solve(const MatX& B, MatX& X) = 0;
  /// Likewise, of one right-hand side.
  virtual SolveStatus solve(const VecX& b, VecX& x) = 0;
  /// Of its whole life.
  virtual const SolverCounters& counters() const = 0;
};

/// Makes a solver from the keys of the spec that it uses.
using MakeLinearSolver = std::unique_ptr<LinearSolver> (*)(const IntegratorSpec&);
/// Linear solvers by name.
using LinearSolverRegistry = Registry<MakeLinearSolver>;

}  // namespace palpate::dynamics
