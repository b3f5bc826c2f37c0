#pragma once
#include <vector>

#include "palpate/dynamics/matrix.h"

namespace palpate::linear {

/// Symmetric part S = (A + A^T) / 2 of a bordered matrix, in A's pattern. An unchanged A yields the unchanged
/// S with the same version, so that a solver that holds its factor need not repeat the factorisation.
class SymmetricPart {
 public:
  /// Returns S of this matrix, valid until the next call. @throws Error if A's pattern is not symmetric
  const dynamics::BorderedMatrix& of(const dynamics::BorderedMatrix& A);
  /// Whether the last A was itself symmetric: its body to rounding, its border exactly.
  bool whole() const { return whole_; }

 private:
  /// Fills transposed_ for a new pattern.
  void find_transposed(const dynamics::BlockSparse& A);

  dynamics::BorderedMatrix S_;
  std::vector<int> transposed_;                             ///< slot of block (j, i) for each slot (i, j)
  std::uint64_t pattern_version_ = 0, values_version_ = 0;  ///< versions of the last A
  bool whole_ = false;
};

}  // namespace palpate::linear
