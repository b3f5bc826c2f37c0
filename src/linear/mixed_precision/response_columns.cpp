#include "linear/mixed_precision/response_columns.h"

#include <algorithm>
#include <utility>

#include <Eigen/Eigenvalues>

#include "palpate/core/error.h"

namespace palpate::linear {
namespace {

/// Smallest relative eigenvalue (squared column norms) of linearly independent columns: single precision
/// cannot distinguish closer ones.
constexpr double kDependenceTolerance = 1e-5;

std::vector<float*> pointers(Columns& columns) {
  std::vector<float*> out;
  for (int k = 0; k < columns.count(); ++k) out.push_back(columns[k].data());
  return out;
}
std::vector<const float*> pointers(const Columns& columns) {
  std::vector<const float*> out;
  for (int k = 0; k < columns.count(); ++k) out.push_back(columns[k].data());
  return out;
}

}  // namespace

void Columns::resize(int count, std::size_t size) {
  if (size != size_) columns_.clear();
  size_ = size;
  count_ = count;
  if (columns_.size() < static_cast<std::size_t>(count))
    columns_.resize(static_cast<std::size_t>(count), Singles(size + kVectorTail, 0.0f));
}

void Columns::swap(Columns& other) noexcept {
  columns_.swap(other.columns_);
  std::swap(count_, other.count_);
  std::swap(size_, other.size_);
}

void Columns::set_zero() {
  for (int k = 0; k < count_; ++k) std::fill((*this)[k].begin(), (*this)[k].end(), 0.0f);
}

MatX Columns::inner(const Columns& W) const {
  MatX out(count_, W.count());
  if (out.size() > 0)
    kernels_->inner_products(count_, W.count(), pointers(*this).data(), pointers(W).data(),
                             static_cast<std::int64_t>(size_), out.data());
  return out;
}

void Columns::add(const Columns& V, const MatX& Y) {
  PALPATE_CHECK(Y.rows() == V.count() && Y.cols() == count_,
                "{} x {} coefficients do not fit {} columns added to {}", Y.rows(), Y.cols(), V.count(),
                count_);
  const Eigen::MatrixXf shares = Y.cast<float>();
  if (shares.size() > 0)
    kernels_->add_columns(V.count(), count_, pointers(V).data(), shares.data(), pointers(*this).data(),
                          static_cast<std::int64_t>(size_));
}

MatX pseudo_inverse(const MatX& G) {
  if (!G.allFinite()) return {};
  const double largest = G.diagonal().size() > 0 ? G.diagonal().maxCoeff() : 0.0;
  if (G.diagonal().size() > 0 && G.diagonal().minCoeff() < -kDependenceTolerance * largest) return {};
  const VecX scale = (G.diagonal().array() > 0.0).select(G.diagonal().array().max(1e-300).rsqrt(), 0.0);
  const Eigen::SelfAdjointEigenSolver<MatX> eigen(scale.asDiagonal() * (0.5 * (G + G.transpose())) *
                                                  scale.asDiagonal());
  const VecX inverse =
      (eigen.eigenvalues().array() > kDependenceTolerance).select(eigen.eigenvalues().array().inverse(), 0.0);
  const MatX V = scale.asDiagonal() * eigen.eigenvectors();
  return V * inverse.asDiagonal() * V.transpose();
}

}  // namespace palpate::linear
