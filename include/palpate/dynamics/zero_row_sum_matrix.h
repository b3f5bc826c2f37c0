#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/point_stiffness.h"
#include "palpate/dynamics/sparse_border.h"

namespace palpate::dynamics {

/// Node that is held along some axes: those rows and columns are identity rows and columns.
struct HeldNode {
  int node;                  ///< Node number, over all node blocks.
  std::array<bool, 3> axes;  ///< Whether x, y, z is held.
};

/// Mixed-precision step matrix. It takes half the memory of a matrix in double, and one assembly pass less:
///     A = diag(m) + L + C,   L_ii = -sum_j L_ij   (j != i).
/// L, stiffness and damping of soft bodies, is invariant to rigid translations: its block rows sum to zero,
/// so that its off-diagonal blocks determine it. They are kept in single precision and written directly to
/// where the solver that owns this object reads them; m is kept in double. Rounding of an L_ij then acts on
/// the difference of two nodes' motions, never on a translation, however large the stiffness is relative to
/// the mass of a node.
/// C is the part outside the sparsity pattern (contact), in double.
///
/// Rigid blocks, if any, are a border of this matrix, in double. Solvers eliminate its symmetric part: they
/// solve with A - B S^-1 B^T, B = (right + bottom^T)/2, S = (corner + corner^T)/2.
struct ZeroRowSumMatrix {
  const BlockSparse* pattern = nullptr;  ///< Sparsity only; its values are not read.
  /// The blocks of the pattern's slots s of (i, j) and of (j, i) are both at values[9 slot_map[s]]; -1 for i
  /// = j.
  std::vector<int> slot_map;
  /// Blocks A_ij, i < j, times `scale`, each row-major; every one is written anew for each matrix.
  std::vector<float> values;
  double scale = 1.0;     ///< Power of two, so that scaling is exact.
  VecX diagonal;          ///< m, per u-direction.
  PointStiffness points;  ///< C
  SparseBorder border;    ///< Rows and columns of rigid blocks; its nodes are nodes of `points`.
  /// Nodal positions [m], as in BorderedMatrix; valid until MixedPrecisionSolver::factor_step_matrix()
  /// returns.
  const double* positions = nullptr;
  const std::vector<HeldNode>* held = nullptr;  ///< Nodes whose held rows are identity rows; null: none.
  std::uint64_t slot_map_key = 0;               ///< Hash of `slot_map` and pattern; 0: none.
};

}  // namespace palpate::dynamics
