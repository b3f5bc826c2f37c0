#pragma once
#include <vector>

#include "palpate/dynamics/matrix.h"

namespace palpate::linear {

/// Scalar rows of a BlockSparse interpreted as compressed columns: the compressed columns of A^T. An LU
/// library with column storage factors A^T and solves A x = b as the transposed system.
struct TransposedColumns {
  int n = 0;
  std::vector<int> start, rows, source;  ///< source: index of each entry in the block matrix's values
  std::vector<double> values;

  /// Builds the pattern; values are set by fill().
  explicit TransposedColumns(const dynamics::BlockSparse& A) : n(3 * A.block_rows()) {
    start.reserve(static_cast<std::size_t>(n) + 1);
    start.push_back(0);
    rows.reserve(A.values().size());
    source.reserve(A.values().size());
    for (int row = 0; row < n; ++row) {
      for (int s = A.row_start()[static_cast<std::size_t>(row / 3)];
           s < A.row_start()[static_cast<std::size_t>(row / 3) + 1]; ++s)
        for (int c = 0; c < 3; ++c) {
          rows.push_back(3 * A.columns()[static_cast<std::size_t>(s)] + c);
          source.push_back(9 * s + 3 * (row % 3) + c);
        }
      start.push_back(static_cast<int>(rows.size()));
    }
    values.assign(rows.size(), 0.0);
  }
  TransposedColumns() = default;

  /// Copies the values of A, whose pattern must be that of the constructor.
  void fill(const dynamics::BlockSparse& A) {
    const double* from = A.values().data();
    for (std::size_t k = 0; k < source.size(); ++k) values[k] = from[source[k]];
  }
};

}  // namespace palpate::linear
