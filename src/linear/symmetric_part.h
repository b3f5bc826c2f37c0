#pragma once
#include <vector>

#include "palpate/dynamics/matrix.h"

namespace palpate::linear {

/// S = (A + A^T) / 2 of a bordered matrix, in A's own pattern.  Of an unchanged A it is the unchanged S,
/// version and all: a solver that has its factor need not make it again.
class SymmetricPart {
 public:
  const dynamics::BorderedMatrix& of(const dynamics::BorderedMatrix& A);
  /// Whether that matrix was symmetric itself, to rounding in its body.
  bool whole() const { return whole_; }

 private:
  void find_transposed(const dynamics::BlockSparse& A);

  dynamics::BorderedMatrix S_;
  std::vector<int> transposed_;                             ///< slot of block (j, i), for each slot (i, j)
  std::uint64_t pattern_version_ = 0, values_version_ = 0;  ///< of A
  bool whole_ = false;
};

}  // namespace palpate::linear
