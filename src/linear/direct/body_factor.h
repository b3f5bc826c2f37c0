#pragma once
#include <string>

#include "palpate/dynamics/linear_solver.h"

namespace palpate::linear {

/// Right-hand sides in the caller's memory, column-major with an outer stride.
using ConstColumns = Eigen::Map<const MatX, 0, Eigen::OuterStride<>>;

/// Smallest admissible ratio of the smallest to the largest pivot of an LU factor with scaled rows. Below it
/// the smallest pivot is rounding error, and the matrix counts as singular.
constexpr double kSmallestPivotRatio = 1e-14;

/// Factor of the sparse body part alone, by a direct solver's library. DirectSolver adds versions, border and
/// counters.
class BodyFactor {
 public:
  virtual ~BodyFactor() = default;
  /// Performs the symbolic analysis of A's pattern and discards any numeric factor.
  virtual void analyse(const dynamics::BlockSparse& A) = 0;
  /// Returns the fill-reducing ordering that the analysis chose; empty where the library offers no choice.
  virtual std::string ordering() const { return {}; }
  /// Returns the number of analyses that computed an ordering.
  virtual long orderings() const { return 0; }
  /// Computes the numeric factor of A, whose pattern was analysed.
  virtual dynamics::SolveStatus factor(const dynamics::BlockSparse& A) = 0;
  /// X = A^-1 B; X is resized to the size of B and must not alias it.
  virtual void solve(const ConstColumns& B, MatX& X) = 0;
};

}  // namespace palpate::linear
