#pragma once
#include <cstdint>
#include <vector>

#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::dynamics {

/// What the fused terms of a System (FusedStepTerm) gave to a step's matrix and right-hand side, kept for
/// whoever asks for the same of them next: a haptic loop linearises its bodies over the period that they then
/// step over, from the same state, and soft bodies are what costs there.
struct KeptStep {
  std::vector<std::uint64_t> versions;  ///< FusedStepTerm::step_version() of each; empty: nothing is kept
  std::uint64_t slot_map_key = 0;       ///< of the matrix
  double scale = 0.0;                   ///< of the matrix
  double d_scale = 0.0, k_scale = 0.0;  ///< of D and K
  VecX q, u, shift;                     ///< of the nodes: positions [m], velocities [m/s], displacements [m]
  std::vector<float> values;            ///< ZeroRowSumMatrix::values
  VecX diagonal;                        ///< what was added to ZeroRowSumMatrix::diagonal
  VecX force;                           ///< force - K shift, of all u-directions [N]
};

}  // namespace palpate::dynamics
