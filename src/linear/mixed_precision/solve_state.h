#pragma once
#include <algorithm>
#include <array>

#include "linear/mixed_precision/projected_guess.h"
#include "linear/mixed_precision/single_iteration.h"

namespace palpate::linear {

/// State of one solve with the matrix in a SingleMatrix: right-hand side, initial guess, the iteration's
/// correction and their sum, in the copy's order. Used by SingleSolve and Refinement.
class SolveState {
 public:
  SolveState(const NodeKernels& kernels, ClusterTeam& team, SingleMatrix& copy,
             const RigidModeCoarseSpace& coarse_space, double rtol, dynamics::SolverCounters& counters);

  static constexpr int kIterationLimit = 1000;
  /// Largest residual reduction over which a recurrence in single precision stays accurate; after it the
  /// residual is recomputed in double.
  static constexpr double kReductionInSingle = 1e-4;

  /// Allocates memory for the copy's order.
  void prepare();
  int nodes() const { return copy.nodes(); }
  /// Begins a new right-hand side; the caller sets b and adds up the guess's sums over it, part by part.
  void begin(bool warm);
  /// Computes the initial guess and its residual norm.
  ProjectedGuess::Start choose();
  /// Sets the iteration's residual: b minus A times the guess, divided by `size`, on nodes [first, last).
  void set_residual(int first, int last) {
    guess.residual(1.0 / size, b.data(), iteration.residual().data(), first, last);
  }
  /// Adds guess and correction to x, where the solution is accumulated from now on; the iteration may
  /// continue.
  void add_correction();
  /// Writes the solution in the caller's order, three numbers per node; returns its largest absolute value.
  /// @param keep  Whether to store it for later starts.
  /// @param follow  Whether to store its product too.
  double put_solution(double* x, bool keep = false, bool follow = false);
  /// Factor from energies of the copy's problem (scale A) d = (b - A x)/size to energies of the matrix:
  /// |x|_A^2 = scale size^2 |d|^2.
  double unit() const { return copy.scale() * size * size; }

  const NodeKernels& kernels;
  ClusterTeam& team;
  SingleMatrix& copy;
  double rtol;
  dynamics::SolverCounters& counters;
  ProjectedGuess guess;
  SingleIteration iteration;
  Doubles b, x;  ///< x: solution if `accumulated`; else it is guess plus correction
  bool accumulated = false;
  double size = 0.0;  ///< b - A x is this times the iteration's residual
  /// Part of the last stored solution that the guess missed, over the whole solution, in the energy norm.
  double correction = 0.0;
  std::vector<double> largest;  ///< largest number per part

 private:
  /// Nodes per block: where the whole solution or product is not needed, it is computed block by block in
  /// cache.
  static constexpr int kNodesOfBlock = 128;
  using Block = std::array<double, 4 * kNodesOfBlock>;
  /// Returns the current solution on these nodes: in `block`, or in x where it is stored.
  const double* solution(int first, int last, Block& block) const;
};

}  // namespace palpate::linear
