#pragma once
#include <vector>

#include "linear/mixed_precision/single_matrix.h"

namespace palpate::linear {

/// A few vectors over the nodes (node_kernels.h), and what conjugate gradients on all of them does with them.
/// Sums are over all nodes in one order: results do not depend on the number of threads.
class Columns {
 public:
  /// Room for `count` columns of `size` numbers each; what they hold is undefined.
  void resize(int count, std::size_t size);
  int count() const { return count_; }
  std::size_t size() const { return size_; }
  Singles& operator[](int k) { return columns_[static_cast<std::size_t>(k)]; }
  const Singles& operator[](int k) const { return columns_[static_cast<std::size_t>(k)]; }
  Singles* data() { return columns_.data(); }
  const Singles* data() const { return columns_.data(); }
  void swap(Columns& other) noexcept;
  void set_zero();

  /// V^T W, count x other.count
  MatX inner(const Columns& W) const;
  /// this += V Y
  void add(const Columns& V, const MatX& Y);

 private:
  const NodeKernels* kernels_ = &node_kernels();
  std::vector<Singles> columns_;
  int count_ = 0;
  std::size_t size_ = 0;
};

/// The inverse of a symmetric positive semi-definite matrix on the space where its energy is more than
/// rounding, in columns scaled to one; zero beside it.  Empty where an entry is not finite or a diagonal one
/// is far below zero.
MatX pseudo_inverse(const MatX& G);

}  // namespace palpate::linear
