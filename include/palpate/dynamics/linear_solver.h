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

/// Outcome of a factorisation or a solve: success; no Cholesky factor exists; the matrix is singular or not
/// finite; the iteration did not converge.
enum class SolveStatus { kOk, kIndefinite, kSingular, kNotConverged };

/// Work done by a linear solver since it was made.
struct SolverCounters {
  long symbolic = 0;  ///< Symbolic analyses (one per pattern).
  /// Symbolic analyses that searched for a fill-reducing ordering, in solvers that reuse an ordering from
  /// pattern to pattern.
  long orderings = 0;
  long factorisations = 0;   ///< Numeric factorisations.
  long solves = 0;           ///< Right-hand sides solved.
  long iterations = 0;       ///< Iterations of iterative methods.
  long lagged = 0;           ///< Right-hand sides solved by refinement with the matrix of an earlier one.
  long residual_checks = 0;  ///< Residuals evaluated for these.
  long refreshes = 0;        ///< Recomputations of a coarse space, in methods that keep one.
  double symbolic_s = 0.0, factor_s = 0.0, solve_s = 0.0;  ///< Wall time [s].
  /// Fill-reducing ordering of the last analysis, where the solver chooses: "AMD", "METIS".
  std::string ordering;

  /// Adds the counts of another solver; `ordering` is unchanged.
  SolverCounters& operator+=(const SolverCounters& other);
};

/// Calls f(name, members...) for every number of these counters, with the same member of each argument. The
/// type gives the unit: long is a count, double is wall time [s]. The names are used in summary.json, in the
/// database of a study and in compare.csv.
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

/// Returns the bytes of the numbers that visit_counters() visits. Together with the members that are not
/// numbers they must add up to the size of the struct.
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

/// Solves A X = B for a bordered matrix. Symbolic analysis is done once per pattern version, numeric work
/// only when the version of the values changed. Abilities that only some solvers have are optional capability
/// classes, which a solver inherits in addition to this class: mixed_precision_step.h.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  /// Returns the name used in scenes.
  virtual std::string name() const = 0;
  /// Returns whether it accepts matrices that are not symmetric.
  virtual bool supports_unsymmetric() const = 0;
  /// Returns whether it accepts matrices that are not positive definite, or whose symmetric part is not.
  virtual bool supports_indefinite() const { return supports_unsymmetric(); }
  /// Prepares for solves with A; cheap when neither its pattern nor its values changed. Returns kIndefinite
  /// where no Cholesky factor exists.
  /// @pre A stays at its address, unchanged, until the last solve with it: an iterative method reads it
  ///   there.
  virtual SolveStatus factor(const BorderedMatrix& A) = 0;
  /// Computes X = A^-1 B for the matrix last factored; B and X are size x nrhs and may be the same object.
  virtual SolveStatus solve(const MatX& B, MatX& X) = 0;
  /// Computes x = A^-1 b for one right-hand side; b and x may be the same object.
  virtual SolveStatus solve(const VecX& b, VecX& x) = 0;
  /// Returns the work done since construction.
  virtual const SolverCounters& counters() const = 0;
};

/// Factory of a solver, from the keys of the spec that it uses.
using MakeLinearSolver = std::unique_ptr<LinearSolver> (*)(const IntegratorSpec&);
/// Linear solvers by name.
using LinearSolverRegistry = Registry<MakeLinearSolver>;

}  // namespace palpate::dynamics
