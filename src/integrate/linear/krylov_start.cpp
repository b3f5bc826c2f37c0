#include "integrate/linear/krylov_start.h"

#include <algorithm>
#include <cmath>

namespace palpate::integrate {
namespace {

struct Pointers {
  const float *V[kMostColumns] = {}, *AV[kMostColumns] = {};
  Pointers(int count, const Singles* solutions, const Singles* products) {
    for (int k = 0; k < count; ++k) {
      V[k] = solutions[k].data();
      AV[k] = products[k].data();
    }
  }
};

}  // namespace

void KrylovStart::prepare(const NodeOrder& order) {
  for (int k = 0; k < most_; ++k)
    for (Singles* v : {&V_[k], &AV_[k]}) v->assign(4 * order.node.size() + kVectorTail, 0.0f);
  partial_.assign(static_cast<std::size_t>(order.parts()), {});
  count_ = 0;
  known_ = followed_ = false;
  std::fill_n(share_, kMostColumns, 1.0);
}

void KrylovStart::gather_sums(const Doubles& b) {
  const Pointers at(count_, V_, AV_);
  team_.for_each([&](std::size_t c, int first, int last) { kernels_.gram(count_, at.V, at.AV, b.data(), first, last, partial_[c].data()); });
  std::array<double, kMostSums> sums{};
  for (const auto& part : partial_)
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += part[k];
  std::size_t k = 0;
  for (int j = 0; j < count_; ++j)
    for (int i = 0; i <= j; ++i) own_[j][i] = sums[k++];
  for (int j = 0; j < count_; ++j) right_[j] = sums[k++];
}

/// By Cholesky, column by column.  @return y . V^T b
double KrylovStart::solve(double* y) const {
  double L[kMostColumns][kMostColumns] = {}, c[kMostColumns] = {};
  bool used[kMostColumns] = {};
  double energy = 0.0;
  for (int j = 0; j < count_; ++j) {
    double pivot = own_[j][j];
    for (int i = 0; i < j; ++i) {
      if (!used[i]) continue;
      double s = own_[j][i];
      for (int k = 0; k < i; ++k) s -= L[j][k] * L[i][k];
      L[j][i] = s / L[i][i];
      pivot -= L[j][i] * L[j][i];
    }
    if (!(pivot > 1e-10 * own_[j][j])) continue;
    used[j] = true;
    L[j][j] = std::sqrt(pivot);
    c[j] = right_[j];
    for (int k = 0; k < j; ++k) c[j] -= L[j][k] * c[k];
    c[j] /= L[j][j];
    energy += c[j] * c[j];
  }
  for (int j = count_ - 1; j >= 0; --j) {
    y[j] = 0.0;
    if (!used[j]) continue;
    y[j] = c[j];
    for (int i = j + 1; i < count_; ++i) y[j] -= L[i][j] * y[i];
    y[j] /= L[j][j];
  }
  return energy;
}

KrylovStart::Start KrylovStart::combine(bool warm, double scale, const Doubles& b, Doubles& x, Doubles& Ax) {
  const int count = warm ? count_ : 0;
  double y[kMostColumns] = {}, energy = 0.0, change = 0.0;  // V y solves (scale A) V y = b
  if (count > 0) {
    gather_sums(b);
    energy = solve(y);
    double difference[kMostColumns];
    for (int j = 0; j < count; ++j) {
      difference[j] = y[j] - share_[j] * unit_ / scale;
      for (int i = 0; i <= j; ++i) change += (i < j ? 2.0 : 1.0) * difference[j] * own_[j][i] * difference[i];
    }
    for (int j = 0; j < count; ++j) share_[j] = y[j] * scale / unit_;
  }
  return {scale * energy, add_up(count, y, scale, b, x, Ax), scale * std::max(0.0, change)};
}

void KrylovStart::foresee(double scale, Doubles& x, Doubles& Ax) {
  double y[kMostColumns];
  for (int j = 0; j < kMostColumns; ++j) y[j] = share_[j] * unit_ / scale;
  add_up(count_, y, scale, x, x, Ax);
}

/// x and Ax of coefficients y; returns |b - A x|.
double KrylovStart::add_up(int count, const double* y, double scale, const Doubles& b, Doubles& x, Doubles& Ax) {
  const Pointers at(count, V_, AV_);
  team_.for_each(
      [&](std::size_t c, int first, int last) { partial_[c][0] = kernels_.combine(count, y, scale, at.V, at.AV, b.data(), x.data(), Ax.data(), first, last); });
  double square = 0.0;
  for (const auto& part : partial_) square += part[0];
  return std::sqrt(square);
}

void KrylovStart::keep(const Doubles& x, double largest, double scale, const Doubles* Ax) {
  if (!(largest > 0.0)) return;
  const double unit = std::ldexp(1.0, std::ilogb(largest)), by = 1.0 / unit, change = unit_ / unit;
  unit_ = unit;
  count_ = std::min(count_ + 1, most_);
  known_ = false;
  followed_ = followed_ && Ax;
  float *V[kMostColumns], *AV[kMostColumns];
  for (int k = 0; k < count_; ++k) {
    V[k] = V_[k].data();
    AV[k] = AV_[k].data();
  }
  team_.for_each([&](std::size_t, int first, int last) {
    kernels_.difference(count_, by, change, x.data(), V, first, last);
    if (followed_) kernels_.difference(count_, scale * by, change, Ax->data(), AV, first, last);
  });
}

}  // namespace palpate::integrate
