#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/point_stiffness.h"

namespace palpate::dynamics {

/// A node that is held along some axes: those rows and columns are the identity's.
struct HeldNode {
  int node;                  ///< counted over all node blocks
  std::array<bool, 3> axes;  ///< x, y, z: which are held
};

/// A mixed-precision step matrix, in half the memory of one in double and assembled in one pass less:
///     A = diag(m) + L + C,   L_ii = -sum_j L_ij   (j != i).
/// L, stiffness and damping of soft bodies, takes no energy from a rigid translation: its block rows sum to
/// zero, and its off-diagonal blocks determine it. They are kept in single precision, written straight to
/// where the solver that owns this reads them; m is kept in double.  Rounding an L_ij then acts on the
/// difference of two nodes' motions, never on a translation, however much stiffer than heavy a node is.
/// C is what stands beside the pattern (contact), in double.
struct ZeroRowSumMatrix {
  const BlockSparse* pattern = nullptr;  ///< of whose values nothing is read
  /// the block of the pattern's slots s of (i, j) and of (j, i) alike is at values[9 slot_map[s]]; -1 for
  /// i = j
  std::vector<int> slot_map;
  /// blocks A_ij, i < j, times `scale`, each row by row; every one is written anew for each matrix
  std::vector<float> values;
  double scale = 1.0;     ///< a power of two, so that nothing is lost by it
  VecX diagonal;          ///< m, of u-directions
  PointStiffness points;  ///< C
  /// of the nodes [m], as in BorderedMatrix; valid until MixedPrecisionSolver::factor_step_matrix() returns
  const double* positions = nullptr;
  const std::vector<HeldNode>* held = nullptr;  ///< nodes whose rows are the identity's; null: none
  std::uint64_t slot_map_key = 0;               ///< a hash of `slot_map` and pattern; 0: none
};

}  // namespace palpate::dynamics
