#pragma once
#include "product/fem.h"

namespace palpate::bench {

/// Numbers that determine the work of one step.
struct StepCounts {
  double nodes = 0.0, tetrahedra = 0.0, blocks = 0.0;
  double iterations = 0.0;  ///< of the linear solver
  double starts = 3.0;      ///< earlier solutions that it starts from
  bool fused = false;       ///< fused assembly; blocks off the diagonal in single precision alone
  bool lagged = false;      ///< solved by refinement with the matrix of an earlier step
};

/// The least that each stage of a linearly implicit step (warped tangent, no damping, solved by conjugate
/// gradients in single precision) must do.
struct StepWork {
  StageWork force, matrix, factor, solve;
  double working_set = 0.0;        ///< bytes that a step touches again one step later
  double solve_working_set = 0.0;  ///< bytes that an iteration touches again one iteration later
};
StepWork work_of(const StepCounts& counts);

/// The least that one evaluation over the elements must do.
/// @param stage  as ElementTiming names them
/// @throws InternalError for another name
StageWork element_work(const std::string& stage, const StepCounts& counts);

/// Memory that such steps need [bytes]: elements, pattern, matrix and its copy in single precision,
/// vectors.
double bytes_to_store(const StepCounts& counts);

}  // namespace palpate::bench
