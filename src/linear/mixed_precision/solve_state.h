#pragma once
#include <algorithm>
#include <array>

#include "linear/mixed_precision/projected_guess.h"
#include "linear/mixed_precision/single_iteration.h"

namespace palpate::linear {

/// One right-hand side of the matrix that a SingleMatrix holds, on its way to a solution: the right-hand
/// side, the initial guess, the iteration's correction and their sum, in the copy's order.  SingleSolve and
/// Refinement drive it.
class SolveState {
 public:
  SolveState(const NodeKernels& kernels, ClusterTeam& team, SingleMatrix& copy,
             const RigidModeCoarseSpace& coarse_space, double rtol, dynamics::SolverCounters& counters);

  static constexpr int kIterationLimit = 1000;
  /// Single precision keeps a recurrence honest over so much of a reduction; then the residual is computed
  /// anew, in double.
  static constexpr double kReductionInSingle = 1e-4;

  /// Memory for the copy's order.
  void prepare();
  int nodes() const { return copy.nodes(); }
  /// A new right-hand side; b and the guess's sums over it are for the caller to make, part by part.
  void begin(bool warm);
  /// The initial guess and its residual.
  ProjectedGuess::Start choose();
  /// The iteration's residual: b less what the guess accounts for, on nodes [first, last).
  void set_residual(int first, int last) {
    guess.residual(1.0 / size, b.data(), iteration.residual().data(), first, last);
  }
  /// The solution so far into x, which it is accumulated in from now on; the iteration may find more.
  void add_correction();
  /// The solution in the order and shape of its caller; returns its largest number.  @param keep  as one to
  /// start from, with its product if `follow`
  double put_solution(double* x, bool keep = false, bool follow = false);
  /// Energies of the copy's problem (A scale) d = (b - A x)/size in units of the matrix's own: |x|_A^2 =
  /// scale size^2 |d|^2.
  double unit() const { return copy.scale() * size * size; }

  const NodeKernels& kernels;
  ClusterTeam& team;
  SingleMatrix& copy;
  double rtol;
  dynamics::SolverCounters& counters;
  ProjectedGuess guess;
  SingleIteration iteration;
  Doubles b, x;  ///< x: where it is `accumulated`; else guess and correction make the solution
  bool accumulated = false;
  double size = 0.0;  ///< the iteration's residual times this is b - A x
  /// The part of the last remembered solution that the guess did not foresee, over the whole, in the energy
  /// norm.
  double correction = 0.0;
  std::vector<double> largest;  ///< one a part

 private:
  /// Solutions and products are made a block of nodes at a time, in memory that the cache holds, where nobody
  /// asks for the whole of them.
  static constexpr int kNodesOfBlock = 128;
  using Block = std::array<double, 4 * kNodesOfBlock>;
  /// The solution so far on these nodes: in `block`, or in x where it is at hand.
  const double* solution(int first, int last, Block& block) const;
};

}  // namespace palpate::linear
