#pragma once
#include <vector>

#include "linear/mixed_precision/single_matrix.h"

namespace palpate::linear {

/// A few vectors over the nodes (node_kernels.h) with the block operations of conjugate gradients. Sums over
/// the nodes have a fixed order: results do not depend on the number of threads.
class Columns {
 public:
  /// Resizes to `count` columns of `size` numbers each; their contents are undefined.
  void resize(int count, std::size_t size);
  int count() const { return count_; }
  std::size_t size() const { return size_; }
  Singles& operator[](int k) { return columns_[static_cast<std::size_t>(k)]; }
  const Singles& operator[](int k) const { return columns_[static_cast<std::size_t>(k)]; }
  Singles* data() { return columns_.data(); }
  const Singles* data() const { return columns_.data(); }
  void swap(Columns& other) noexcept;
  void set_zero();

  /// Returns V^T W for V = *this, count x W.count().
  MatX inner(const Columns& W) const;
  /// this += V Y, Y of V.count() x count.
  void add(const Columns& V, const MatX& Y);

 private:
  const NodeKernels* kernels_ = &node_kernels();
  std::vector<Singles> columns_;
  int count_ = 0;
  std::size_t size_ = 0;
};

/// Returns the pseudo-inverse of a symmetric positive semi-definite matrix: its inverse on the space where
/// the energy exceeds rounding, zero on the complement, computed with columns scaled to a unit diagonal.
/// Returns an empty matrix if an entry is not finite or a diagonal entry is far below zero.
MatX pseudo_inverse(const MatX& G);

}  // namespace palpate::linear
