#pragma once
#include <cstdint>
#include <vector>

#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::dynamics {

/// Contribution of the fused terms of a System (FusedStepTerm) to the matrix and right-hand side of a step,
/// kept for reuse. A haptic loop linearises the bodies over the period that they then step over, from the
/// same state, and the soft bodies dominate the cost of both.
struct CachedStep {
  /// FusedStepTerm::step_version() of each term; empty: nothing is kept.
  std::vector<std::uint64_t> versions;
  std::uint64_t slot_map_key = 0;       ///< Key of the matrix (ZeroRowSumMatrix::slot_map_key).
  double scale = 0.0;                   ///< Scale of the matrix (ZeroRowSumMatrix::scale).
  double d_scale = 0.0, k_scale = 0.0;  ///< Factors of D and K.
  VecX q, u, shift;                     ///< Nodal positions [m], velocities [m/s] and displacements [m].
  std::vector<float> values;            ///< ZeroRowSumMatrix::values
  VecX diagonal;                        ///< Part added to ZeroRowSumMatrix::diagonal.
  VecX force;                           ///< force - K shift, all u-directions [N].
};

}  // namespace palpate::dynamics
