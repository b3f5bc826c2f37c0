#include "linear/mixed_precision/projected_guess.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace palpate::linear {
namespace {
/// Most binary orders of magnitude between the magnitudes of related solutions.
constexpr int kMostOrders = 60;
/// Largest coefficient that a start passes on to the extrapolation of the next one. Larger ones express a
/// solution by others that are unrelated to it (rounding before a first contact); extrapolated, they exceed
/// the solution by orders of magnitude, and its digits are lost in residuals of that.
constexpr double kMostShare = 1e6;
}  // namespace

void ProjectedGuess::prepare(const NodeOrder& order) {
  for (int k = 0; k < most_; ++k) {
    for (Singles* v : {&V_[k], &AV_[k]}) v->assign(4 * order.node.size() + kVectorTail, 0.0f);
    at_V_[k] = V_[k].data();
    at_AV_[k] = AV_[k].data();
  }
  partial_.assign(static_cast<std::size_t>(order.parts()), {});
  forget();
}

void ProjectedGuess::begin(bool warm, double scale) {
  scale_ = scale;
  used_ = warm ? count_ : 0;
  for (int j = 0; j < used_; ++j) {
    of_V_[j] = share_[j] * unit_;
    of_AV_[j] = of_V_[j] / scale;
  }
}

void ProjectedGuess::add_up(std::size_t part, const double* b, int first, int last) {
  kernels_.gram(used_, of_AV_, at_V_, at_AV_, b, first, last, partial_[part].data());
}

/// Solves by Cholesky, column by column. Returns y . V^T b for y = of_AV_.
double ProjectedGuess::solve() {
  double* y = of_AV_;
  double L[kMostColumns][kMostColumns] = {}, c[kMostColumns] = {};
  bool used[kMostColumns] = {};
  double energy = 0.0;
  for (int j = 0; j < used_; ++j) {
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
  for (int j = used_ - 1; j >= 0; --j) {
    y[j] = 0.0;
    if (!used[j]) continue;
    y[j] = c[j];
    for (int i = j + 1; i < used_; ++i) y[j] -= L[i][j] * y[i];
    y[j] /= L[j][j];
  }
  return energy;
}

ProjectedGuess::Start ProjectedGuess::choose() {
  std::array<double, kMostSums> sums{};
  for (const auto& part : partial_)
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += part[k];
  std::size_t at = 0;
  for (int j = 0; j < used_; ++j)
    for (int i = 0; i <= j; ++i) own_[j][i] = sums[at++];
  for (int j = 0; j < used_; ++j) right_[j] = sums[at++];
  const double left = std::sqrt(sums[at]);
  double foreseen[kMostColumns], change = 0.0;
  std::copy_n(of_AV_, used_, foreseen);
  const double energy = solve();  // (scale A) V y = b
  for (int j = 0; j < used_; ++j) {
    foreseen[j] = of_AV_[j] - foreseen[j];
    for (int i = 0; i <= j; ++i) change += (i < j ? 2.0 : 1.0) * foreseen[j] * own_[j][i] * foreseen[i];
    of_V_[j] = of_AV_[j] * scale_;
    share_[j] = of_V_[j] / unit_;
  }
  if (std::any_of(share_, share_ + used_, [](double share) { return !(std::abs(share) <= kMostShare); }))
    std::fill_n(share_, kMostColumns, 1.0);
  return {scale_ * energy, scale_ * std::max(0.0, change), left == 0.0 ? 1.0 : left};
}

void ProjectedGuess::solution(double* x, int first, int last) const {
  kernels_.combine(used_, of_V_, at_V_, x, first, last);
}
void ProjectedGuess::product(double* Ax, int first, int last) const {
  kernels_.combine(used_, of_AV_, at_AV_, Ax, first, last);
}
void ProjectedGuess::residual(double by, const double* b, float* r, int first, int last) const {
  kernels_.leave(used_, of_AV_, by, at_AV_, b, r, first, last);
}

void ProjectedGuess::begin_to_keep(double scale, bool with_products) {
  scale_ = scale;
  count_ = std::min(count_ + 1, most_);
  known_ = false;
  followed_ = followed_ && with_products;
  by_ = 1.0 / next_unit_;
  change_ = unit_ / next_unit_;
  unit_ = next_unit_;
}

void ProjectedGuess::keep(const double* x, const double* Ax, int first, int last) {
  kernels_.difference(count_, by_, change_, x, at_V_, first, last);
  if (followed_) kernels_.difference(count_, scale_ * by_, change_, Ax, at_AV_, first, last);
}

/// The unit of V_ is taken from the solution before, so that one pass over x is enough.
void ProjectedGuess::end_to_keep(double largest) {
  if (!(largest > 0.0) || !std::isfinite(largest)) return forget();
  next_unit_ = std::ldexp(1.0, std::ilogb(largest));
  if (std::abs(std::ilogb(largest) - std::ilogb(unit_)) > kMostOrders) forget();
}

void ProjectedGuess::forget() {
  count_ = 0;
  known_ = followed_ = false;
  std::fill_n(share_, kMostColumns, 1.0);
}

}  // namespace palpate::linear
