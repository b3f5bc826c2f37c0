#include "linear/symmetric_part.h"

#include <algorithm>

#include "palpate/core/error.h"

namespace palpate::linear {

using dynamics::BlockSparse;
using dynamics::BorderedMatrix;

/// Relative rounding error of sums of some hundred entries that are added in a different order on either
/// side of the diagonal.
static constexpr double kRounding = 0x1p-48;

void SymmetricPart::find_transposed(const BlockSparse& A) {
  transposed_.resize(static_cast<std::size_t>(A.slot_count()));
  for (int i = 0; i < A.block_rows(); ++i)
    for (int s = A.row_start()[static_cast<std::size_t>(i)];
         s < A.row_start()[static_cast<std::size_t>(i) + 1]; ++s) {
      const int other = A.slot(A.columns()[static_cast<std::size_t>(s)], i);
      PALPATE_CHECK(other >= 0, "the transpose of block ({}, {}) is missing from the pattern", i,
                    A.columns()[static_cast<std::size_t>(s)]);
      transposed_[static_cast<std::size_t>(s)] = other;
    }
}

const BorderedMatrix& SymmetricPart::of(const BorderedMatrix& A) {
  using Block = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
  if (A.values_version != 0 && A.values_version == values_version_ &&
      A.body.pattern_version() == pattern_version_)
    return S_;
  values_version_ = A.values_version;
  if (pattern_version_ == 0 || A.body.pattern_version() != pattern_version_ ||
      S_.body.slot_count() != A.body.slot_count()) {
    S_.body = A.body;
    find_transposed(A.body);
    pattern_version_ = A.body.pattern_version();
  }
  double largest = 0.0, apart = 0.0;
  for (int s = 0; s < A.body.slot_count(); ++s) {
    const int t = transposed_[static_cast<std::size_t>(s)];
    if (t < s) continue;
    const Mat3 upper = Block(A.body.block(s)), lower = Block(A.body.block(t)).transpose();
    const Mat3 mean = 0.5 * (upper + lower);
    largest = std::max(largest, mean.cwiseAbs().maxCoeff());
    apart = std::max(apart, (upper - lower).cwiseAbs().maxCoeff());
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(S_.body.block(s)) = mean;
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(S_.body.block(t)) = mean.transpose();
  }
  whole_ =
      apart <= kRounding * largest && A.right == A.bottom.transpose() && A.corner == A.corner.transpose();
  S_.right = 0.5 * (A.right + A.bottom.transpose());
  S_.bottom = S_.right.transpose();
  S_.corner = 0.5 * (A.corner + A.corner.transpose());
  S_.positions = A.positions;
  S_.symmetric = true;
  S_.touch();
  return S_;
}

}  // namespace palpate::linear
