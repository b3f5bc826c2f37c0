#include "linear/mixed_precision/response_columns.h"

#include <algorithm>
#include <utility>

#include <Eigen/Eigenvalues>

namespace palpate::linear {
namespace {

/// Columns that are alike to this, in squares, are one: single precision does not tell them apart.
constexpr double kAlike = 1e-5;
/// Numbers that are summed in single precision before their sum is added to the others.
constexpr Eigen::Index kChunk = 1024;

Eigen::Map<const Eigen::VectorXf> part(const Singles& v, Eigen::Index at, Eigen::Index count) {
  return {v.data() + at, count};
}

double dot(const Singles& a, const Singles& b, std::size_t size) {
  double sum = 0.0;
  const auto end = static_cast<Eigen::Index>(size);
  for (Eigen::Index at = 0; at < end; at += kChunk) {
    const Eigen::Index count = std::min(kChunk, end - at);
    sum += static_cast<double>(part(a, at, count).dot(part(b, at, count)));
  }
  return sum;
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
  for (int j = 0; j < W.count(); ++j)
    for (int i = 0; i < count_; ++i) out(i, j) = dot((*this)[i], W[j], size_);
  return out;
}

VecX Columns::inner_of_pairs(const Columns& W) const {
  VecX out(count_);
  for (int i = 0; i < count_; ++i) out[i] = dot((*this)[i], W[i], size_);
  return out;
}

void Columns::combine(const Columns& V, const MatX& Y, bool add) {
  const auto end = static_cast<Eigen::Index>(size_);
  for (Eigen::Index at = 0; at < end; at += kChunk) {
    const Eigen::Index count = std::min(kChunk, end - at);
    for (int j = 0; j < count_; ++j) {
      Eigen::Map<Eigen::VectorXf> to((*this)[j].data() + at, count);
      if (!add) to.setZero();
      for (int i = 0; i < V.count(); ++i) to += static_cast<float>(Y(i, j)) * part(V[i], at, count);
    }
  }
}

MatX pseudo_inverse(const MatX& G) {
  if (!G.allFinite()) return {};
  const double largest = G.diagonal().size() > 0 ? G.diagonal().maxCoeff() : 0.0;
  if (G.diagonal().size() > 0 && G.diagonal().minCoeff() < -kAlike * largest) return {};
  const VecX scale = (G.diagonal().array() > 0.0).select(G.diagonal().array().max(1e-300).rsqrt(), 0.0);
  const Eigen::SelfAdjointEigenSolver<MatX> eigen(scale.asDiagonal() * (0.5 * (G + G.transpose())) *
                                                  scale.asDiagonal());
  const VecX inverse =
      (eigen.eigenvalues().array() > kAlike).select(eigen.eigenvalues().array().inverse(), 0.0);
  const MatX V = scale.asDiagonal() * eigen.eigenvectors();
  return V * inverse.asDiagonal() * V.transpose();
}

}  // namespace palpate::linear
