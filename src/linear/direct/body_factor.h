#pragma once
#include <string>

#include "palpate/dynamics/linear_solver.h"

namespace palpate::linear {

using ConstColumns = Eigen::Map<const MatX, 0, Eigen::OuterStride<>>;

/// An LU factor of a matrix with scaled rows whose smallest pivot is below this share of the largest is
/// rounding, not a pivot: singular.
constexpr double kSmallestPivotRatio = 1e-14;

/// A factor of the sparse body part alone: what a direct solver's library gives.  DirectSolver adds versions,
/// border and counters.
class BodyFactor {
 public:
  virtual ~BodyFactor() = default;
  /// Symbolic analysis of A's pattern; forgets any numeric factor.
  virtual void analyse(const dynamics::BlockSparse& A) = 0;
  /// The fill-reducing ordering that the analysis took, where there is a choice.
  virtual std::string ordering() const { return {}; }
  /// How many analyses computed an ordering.
  virtual long orderings() const { return 0; }
  /// Numeric factor of A, whose pattern was analysed.
  virtual dynamics::SolveStatus factor(const dynamics::BlockSparse& A) = 0;
  /// X = A^-1 B; X has the size of B and is another object.
  virtual void solve(const ConstColumns& B, MatX& X) = 0;
};

}  // namespace palpate::linear
