#pragma once
#include "product/fem.h"

namespace palpate::bench {

/// Numbers that determine the work of one step.
struct StepCounts {
  double nodes = 0.0, tetrahedra = 0.0, blocks = 0.0;
  double iterations = 0.0;  ///< Iterations of the linear solver.
  double starts = 3.0;      ///< Earlier solutions used for its initial guess.
  bool fused = false;       ///< Fused assembly; off-diagonal blocks in single precision only.
  bool lagged = false;      ///< Solved by refinement with the matrix of an earlier step.
};

/// Least work of each stage of a linearly implicit step (warped tangent, no damping, solved by conjugate
/// gradients in single precision).
struct StepWork {
  StageWork force, matrix, factor, solve;
  double working_set = 0.0;        ///< Bytes that a step accesses again one step later.
  double solve_working_set = 0.0;  ///< Bytes that an iteration accesses again one iteration later.
};
StepWork work_of(const StepCounts& counts);

/// Returns the least work of one evaluation over the elements.
/// @param stage a stage of ElementTiming
/// @param counts size of the beam
/// @throws InternalError for another name
StageWork element_work(const std::string& stage, const StepCounts& counts);

/// Returns the memory [bytes] that such steps need: elements, pattern, matrix and its copy in single
/// precision, vectors.
double bytes_to_store(const StepCounts& counts);

}  // namespace palpate::bench
