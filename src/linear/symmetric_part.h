#pragma once
#include <vector>

#include "palpate/dynamics/matrix.h"

namespace palpate::linear {

/// S = (A + A^T) / 2 of a bordered matrix, in A's own pattern.
class SymmetricPart {
 public:
  const dynamics::BorderedMatrix& of(const dynamics::BorderedMatrix& A);

 private:
  void find_transposed(const dynamics::BlockSparse& A);

  dynamics::BorderedMatrix S_;
  std::vector<int> transposed_;  ///< slot of block (j, i), for each slot (i, j)
  std::uint64_t pattern_version_ = 0;
};

}  // namespace palpate::linear
