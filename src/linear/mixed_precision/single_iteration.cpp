#include "linear/mixed_precision/single_iteration.h"

#include <algorithm>
#include <cmath>

namespace palpate::linear {

using dynamics::SolveStatus;

namespace {
double sum_of(const std::vector<double>& parts) {
  double sum = 0.0;
  for (const double part : parts) sum += part;
  return sum;
}
}  // namespace

void SingleIteration::prepare() {
  for (Singles* v : {&d_, &r_, &z_, &p_, &q_})
    v->assign(4 * static_cast<std::size_t>(matrix_.nodes()) + kVectorTail, 0.0f);
  bounds_.assign(static_cast<std::size_t>(team_.size()), {});
  partial_.assign(static_cast<std::size_t>(matrix_.order().clusters()), 0.0);
  partial_pq_.assign(static_cast<std::size_t>(matrix_.order().parts()), 0.0);
  y_.assign(static_cast<std::size_t>(clusters_.stride()), 0.0f);
  w_ = y_;
  pieces_.assign(6 * static_cast<std::size_t>(matrix_.order().pieces()), 0.0f);
}

void SingleIteration::clear_correction() {
  std::fill(d_.begin(), d_.end(), 0.0f);
  moved_ = false;
  last_length_ = 0.0f;
}

void SingleIteration::begin(double start) {
  for (EnergyBound& bound : bounds_) bound.begin(start);
}

void SingleIteration::end() {
  for (EnergyBound& bound : bounds_) bound.end();
}

void SingleIteration::restart() {
  moved_ = false;
  pq_ = 0.0;
}

void SingleIteration::precondition(std::size_t cluster, int first, int last) {
  partial_[cluster] = kernels_.jacobi(matrix_.inverse(), r_.data(), z_.data(), first, last) + gather(cluster);
}

/// Sums the forces on a cluster and computes the motions of its pieces; returns these pieces' share of
/// r . P^-1 r.
double SingleIteration::gather(std::size_t cluster) {
  return coarse_on() ? clusters_.gather(cluster, matrix_.order(), kernels_, r_.data(), pieces_.data(),
                                        y_.data() + 6 * cluster)
                     : 0.0;
}

void SingleIteration::coarse(int thread) {
  if (!coarse_on()) return;
  const int size = clusters_.size(), threads = team_.size();
  kernels_.dense(clusters_.inverse(), clusters_.stride(), y_.data(), w_.data(), size * thread / threads,
                 size * (thread + 1) / threads);
}

/// Returns r . P^-1 r.
double SingleIteration::squared_residual() const {
  double coarse = 0.0;
  if (coarse_on())
    for (std::size_t k = 0; k < w_.size(); ++k) coarse += static_cast<double>(y_[k]) * w_[k];
  return sum_of(partial_) + coarse;
}

/// Calls follow(arms, motion, first, last) on the nodes [first, last) of each piece of a cluster with the
/// piece's rigid motion; once with null where there is no coarse space.
template <class Follow>
void SingleIteration::over_motions(std::size_t cluster, int first, int last, Follow&& follow) const {
  if (!coarse_on()) return follow(nullptr, nullptr, first, last);
  const NodeOrder& order = matrix_.order();
  for (auto k = static_cast<std::size_t>(order.piece[cluster]);
       k < static_cast<std::size_t>(order.piece[cluster + 1]); ++k) {
    const RigidModeCoarseSpace::Six motion =
        clusters_.motion(k, pieces_.data() + 6 * k, w_.data() + 6 * cluster);
    follow(clusters_.arm(), motion.data(), order.piece_start[k], order.piece_start[k + 1]);
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
  moved_ = true;
  return true;
}

double SingleIteration::orthogonal_to_last() {
  double zq = 0.0;
  const NodeOrder& order = matrix_.order();
  for (std::size_t c = 0; c < static_cast<std::size_t>(order.clusters()); ++c)
    if (coarse_on())
      over_motions(c, order.start[c], order.start[c + 1],
                   [&](const float* arm, const float* motion, int first, int last) {
                     kernels_.direction(0.0f, 0.0f, z_.data(), arm, motion, d_.data(), z_.data(), first,
                                        last);
                   });
  for (std::size_t i = 0; i < 4 * order.node.size(); ++i) zq += static_cast<double>(z_[i]) * q_[i];
  for (Singles* v : {&w_, &pieces_}) std::fill(v->begin(), v->end(), 0.0f);  // they are added to z now
  return pq_ > 0.0 ? -zq / pq_ : 0.0;
}

SolveStatus SingleIteration::reduce(double& rho_in_out, double beta, double spent, double unit, double rtol,
                                    int left, int& steps) {
  SolveStatus status = SolveStatus::kOk;
  const double rho_start = rho_in_out;
  const bool follows = pq_ > 0.0;  // there is a direction from before
  team_.run([&](int t) {
    EnergyBound& bound = bounds_[static_cast<std::size_t>(t)];
    double rho = rho_start, b = beta;
    float a = 0.0f;  // length of the last step, which is applied when its direction is read for the next one
    for (int k = 1;; ++k) {
      const bool first_one = k == 1 && !follows;
      const auto share = static_cast<float>(b);
      team_.over_clusters(t, [&](std::size_t c, int from, int to) {
        over_motions(c, from, to, [&](const float* arm, const float* motion, int first, int last) {
          if (first_one)
            kernels_.first_direction(z_.data(), arm, motion, d_.data(), p_.data(), first, last);
          else
            kernels_.direction(a, share, z_.data(), arm, motion, d_.data(), p_.data(), first, last);
        });
      });
      team_.barrier();
      team_.over(t, [&](std::size_t part, int, int) {
        partial_pq_[part] = matrix_.product(part, p_.data(), q_.data());
      });
      team_.barrier();
      const double pq = sum_of(partial_pq_);
      const bool bad = !(pq > 0.0) || !std::isfinite(pq);
      if (!bad) {
        a = static_cast<float>(rho / pq);
        team_.over_clusters(t, [&](std::size_t c, int first, int last) {
          partial_[c] =
              kernels_.update(a, q_.data(), matrix_.inverse(), r_.data(), z_.data(), first, last) + gather(c);
        });
        team_.barrier();
        coarse(t);
        if (coarse_on()) team_.barrier();
        const double next = squared_residual();
        bound.step(rho / pq, rho * unit, next * unit);
        b = next / rho;
        rho = next;
      }
      const bool end =
          bad || !std::isfinite(rho) || reached(bound, rho * unit, rtol) || rho <= spent || k >= left;
      if (!end) continue;
      if (t == 0) {
        steps = k;
        rho_in_out = rho;
        pq_ = pq;
        moved_ = true;
        last_length_ = a;
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

}  // namespace palpate::linear
