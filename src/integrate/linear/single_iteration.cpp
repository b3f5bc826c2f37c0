#include "integrate/linear/single_iteration.h"

#include <algorithm>
#include <cmath>

namespace palpate::integrate {

using dynamics::SolveStatus;

namespace {
double sum_of(const std::vector<double>& parts) {
  double sum = 0.0;
  for (const double part : parts) sum += part;
  return sum;
}
}  // namespace

void SingleIteration::prepare() {
  for (Singles* v : {&d_, &r_, &z_, &p_, &q_}) v->assign(4 * static_cast<std::size_t>(matrix_.nodes()) + kVectorTail, 0.0f);
  bounds_.assign(static_cast<std::size_t>(team_.size()), {});
  partial_.assign(static_cast<std::size_t>(matrix_.order().clusters()), 0.0);
  partial_pq_.assign(static_cast<std::size_t>(matrix_.order().parts()), 0.0);
  y_.assign(static_cast<std::size_t>(clusters_.stride()), 0.0f);
  w_ = y_;
  pieces_.assign(6 * static_cast<std::size_t>(matrix_.order().pieces()), 0.0f);
}

void SingleIteration::clear_correction() { std::fill(d_.begin(), d_.end(), 0.0f); }

void SingleIteration::begin(double start) {
  for (EnergyBound& bound : bounds_) bound.begin(start);
}

void SingleIteration::end() {
  for (EnergyBound& bound : bounds_) bound.end();
}

void SingleIteration::forget_direction() {
  std::fill(p_.begin(), p_.end(), 0.0f);
  pq_ = 0.0;
}

double SingleIteration::precondition() {
  team_.run([&](int t) {
    team_.over_clusters(t, [&](std::size_t c, int first, int last) {
      partial_[c] = kernels_.jacobi(matrix_.inverse(), r_.data(), z_.data(), first, last) + gather(c);
    });
    team_.barrier();
    coarse(t);
  });
  return sum_of(partial_) + coarse_share();
}

/// Forces on a cluster and motions of its pieces; returns these pieces' share of r . P^-1 r.
double SingleIteration::gather(std::size_t cluster) {
  return coarse_on() ? clusters_.gather(cluster, matrix_.order(), kernels_, r_.data(), pieces_.data(), y_.data() + 6 * cluster) : 0.0;
}

void SingleIteration::coarse(int thread) {
  if (!coarse_on()) return;
  const int size = clusters_.size(), threads = team_.size();
  kernels_.dense(clusters_.inverse(), clusters_.stride(), y_.data(), w_.data(), size * thread / threads, size * (thread + 1) / threads);
}

double SingleIteration::coarse_share() const {
  double sum = 0.0;
  if (coarse_on())
    for (std::size_t k = 0; k < w_.size(); ++k) sum += static_cast<double>(y_[k]) * w_[k];
  return sum;
}

/// d += a p, then p = z + rigid motions + b p on the nodes [first, last) of a cluster.
void SingleIteration::direction(std::size_t cluster, float a, float b, float* d, float* p, int first, int last) const {
  if (!coarse_on()) return kernels_.direction(a, b, z_.data(), nullptr, nullptr, d, p, first, last);
  const NodeOrder& order = matrix_.order();
  for (auto k = static_cast<std::size_t>(order.piece[cluster]); k < static_cast<std::size_t>(order.piece[cluster + 1]); ++k) {
    const RigidClusters::Six motion = clusters_.motion(k, pieces_.data() + 6 * k, w_.data() + 6 * cluster);
    kernels_.direction(a, b, z_.data(), clusters_.arm(), motion.data(), d, p, order.piece_start[k], order.piece_start[k + 1]);
  }
}

bool SingleIteration::minimise_along_last() {
  if (!(pq_ > 0.0)) return false;
  double rp = 0.0;
  for (std::size_t i = 0; i < r_.size(); ++i) rp += static_cast<double>(r_[i]) * p_[i];
  const auto a = static_cast<float>(rp / pq_);
  for (std::size_t i = 0; i < r_.size(); ++i) {
    d_[i] += a * p_[i];
    r_[i] -= a * q_[i];
  }
  return true;
}

double SingleIteration::orthogonal_to_last() {
  double zq = 0.0;
  const NodeOrder& order = matrix_.order();
  for (std::size_t c = 0; c < static_cast<std::size_t>(order.clusters()); ++c)
    if (coarse_on()) direction(c, 0.0f, 0.0f, d_.data(), z_.data(), order.start[c], order.start[c + 1]);
  for (std::size_t i = 0; i < 4 * order.node.size(); ++i) zq += static_cast<double>(z_[i]) * q_[i];
  for (Singles* v : {&w_, &pieces_}) std::fill(v->begin(), v->end(), 0.0f);  // are in z now
  return pq_ > 0.0 ? -zq / pq_ : 0.0;
}

SolveStatus SingleIteration::reduce(double& rho_in_out, double beta, double spent, double unit, double rtol, int left, int& steps) {
  SolveStatus status = SolveStatus::kOk;
  const double rho_start = rho_in_out;
  team_.run([&](int t) {
    EnergyBound& bound = bounds_[static_cast<std::size_t>(t)];
    double rho = rho_start, b = beta;
    float a = 0.0f;  // the last step's length: that step is taken when its direction is read for the next one
    for (int k = 1;; ++k) {
      team_.over_clusters(t, [&](std::size_t c, int first, int last) { direction(c, a, static_cast<float>(b), d_.data(), p_.data(), first, last); });
      team_.barrier();
      team_.over(t, [&](std::size_t part, int, int) { partial_pq_[part] = matrix_.product(part, p_.data(), q_.data()); });
      team_.barrier();
      const double pq = sum_of(partial_pq_);
      const bool bad = !(pq > 0.0) || !std::isfinite(pq);
      if (!bad) {
        a = static_cast<float>(rho / pq);
        team_.over_clusters(t, [&](std::size_t c, int first, int last) {
          partial_[c] = kernels_.update(a, q_.data(), matrix_.inverse(), r_.data(), z_.data(), first, last) + gather(c);
        });
        team_.barrier();
        coarse(t);
        if (coarse_on()) team_.barrier();
        const double next = sum_of(partial_) + coarse_share();
        bound.step(rho / pq, rho * unit, next * unit);
        b = next / rho;
        rho = next;
      }
      const bool end = bad || !std::isfinite(rho) || reached(bound, rho * unit, rtol) || rho <= spent || k >= left;
      if (!end) continue;
      if (!bad)
        team_.over(t, [&](std::size_t, int first, int last) {
          for (std::size_t i = 4 * static_cast<std::size_t>(first); i < 4 * static_cast<std::size_t>(last); ++i) d_[i] += a * p_[i];
        });
      if (t == 0) {
        steps = k;
        rho_in_out = rho;
        pq_ = pq;
        if (bad)
          status = pq <= 0.0 ? SolveStatus::kIndefinite : SolveStatus::kNotConverged;
        else if (!std::isfinite(rho) || (k >= left && !reached(bound, rho * unit, rtol)))
          status = SolveStatus::kNotConverged;
      }
      return;
    }
  });
  return status;
}

}  // namespace palpate::integrate
