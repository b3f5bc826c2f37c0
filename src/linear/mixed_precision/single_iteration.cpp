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
  bound_ = {};
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

/// Computes the motions of the clusters, w = E^-1 y, row by row.
void SingleIteration::coarse() {
  if (!coarse_on()) return;
  team_.for_each_range(clusters_.size(), [&](int first, int last) {
    kernels_.dense(clusters_.inverse(), clusters_.stride(), y_.data(), w_.data(), first, last);
  });
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

// Each pass over the nodes is a shared loop; sums and decisions are the calling thread's.
SolveStatus SingleIteration::reduce(double& rho, double beta, double spent, double unit, double rtol,
                                    int left, int& steps) {
  const bool follows = pq_ > 0.0;  // there is a direction from before
  last_length_ = 0.0f;             // of a step, which is applied when its direction is read for the next one
  for (steps = 1;; ++steps) {
    step_direction(static_cast<float>(beta), steps == 1 && !follows);
    team_.for_each(
        [&](std::size_t part, int, int) { partial_pq_[part] = matrix_.product(part, p_.data(), q_.data()); });
    pq_ = sum_of(partial_pq_);
    moved_ = true;
    if (!(pq_ > 0.0) || !std::isfinite(pq_))
      return pq_ <= 0.0 ? SolveStatus::kIndefinite : SolveStatus::kNotConverged;
    last_length_ = static_cast<float>(rho / pq_);
    team_.for_each_cluster([&](std::size_t c, int first, int last) {
      partial_[c] =
          kernels_.update(last_length_, q_.data(), matrix_.inverse(), r_.data(), z_.data(), first, last) +
          gather(c);
    });
    coarse();
    const double next = squared_residual();
    bound_.step(rho / pq_, rho * unit, next * unit);
    beta = next / rho;
    rho = next;
    if (!std::isfinite(rho)) return SolveStatus::kNotConverged;
    if (reached(rho * unit, rtol)) return SolveStatus::kOk;
    if (steps >= left) return SolveStatus::kNotConverged;
    if (rho <= spent) return SolveStatus::kOk;
  }
}

/// d += (last length) p, p = z + beta p; p = z for the first direction.
void SingleIteration::step_direction(float beta, bool first_one) {
  team_.for_each_cluster([&](std::size_t c, int from, int to) {
    over_motions(c, from, to, [&](const float* arm, const float* motion, int first, int last) {
      if (first_one)
        kernels_.first_direction(z_.data(), arm, motion, d_.data(), p_.data(), first, last);
      else
        kernels_.direction(last_length_, beta, z_.data(), arm, motion, d_.data(), p_.data(), first, last);
    });
  });
}

}  // namespace palpate::linear
