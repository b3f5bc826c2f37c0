#include "linear/mixed_precision/energy_bound.h"

#include <algorithm>

namespace palpate::linear {
namespace {
constexpr double kBelowRitz = 0.5;
/// Smallest mu: smaller eigenvalues cannot be distinguished from zero in single precision.
constexpr double kLeast = 1e-30;
}  // namespace

void EnergyBound::begin(double start, double rise) {
  start_ = start;
  gained_ = 0.0;
  lost_ = false;
  alpha_.clear();
  ratio_.clear();
  if (!first_) mu_ = std::min(1.0, rise * mu_);
  restart();
}

void EnergyBound::restart() {
  test_ = 1.0 / mu_;
  bound_ = 1.0 / (kBelowRitz * mu_);
}

void EnergyBound::limit(double mu) {
  if (mu >= mu_) return;
  mu_ = mu;
  restart();
}

bool EnergyBound::advance(double alpha, double ratio) {
  const double above = test_ - alpha, safe = bound_ - alpha;
  if (!(above > 0.0)) return false;
  test_ = above / (mu_ * above + ratio);
  bound_ = safe / (kBelowRitz * mu_ * safe + ratio);
  return true;
}

void EnergyBound::step(double alpha, double rho, double rho_next) {
  gained_ += alpha * rho;
  if (lost_) return;
  alpha_.push_back(alpha);
  ratio_.push_back(rho_next / rho);
  if (advance(alpha, ratio_.back())) return;
  const double known = mu_;
  while ((mu_ *= 0.5) > kLeast) {
    restart();
    bool held = true;
    for (std::size_t k = 0; k < alpha_.size() && held; ++k) held = advance(alpha_[k], ratio_[k]);
    if (held) return;
  }
  mu_ = known;
  lost_ = true;
}

}  // namespace palpate::linear
