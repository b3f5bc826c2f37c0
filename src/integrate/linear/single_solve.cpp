#include "integrate/linear/single_solve.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::integrate {

using dynamics::SolveStatus;

namespace {
/// A solve that asks for no more than this reduction needs no look at the residual in double at its end.
constexpr double kReductionUnchecked = 1e-3;
/// Products of the start are in single precision: what rounding leaves of them, some 1e-7 of the solution in the energy norm, is far below such a tolerance.
constexpr double kTrustsSingleStart = 1e-5;
constexpr int kResidualReplacements = 40;
/// Solutions to start from: many for tight tolerances, few for others, where one more saves less in iterations than it costs.
constexpr double kManyStarts = 1e-4;
constexpr int kFewColumns = 3;
}  // namespace

SingleSolve::SingleSolve(const NodeKernels& kernels, ClusterTeam& team, SingleMatrix& copy, const RigidClusters& clusters, double rtol, dynamics::SolverCounters& counters)
    : kernels_(kernels), team_(team), copy_(copy), rtol_(rtol), counters_(counters), start_(kernels, team, rtol < kManyStarts ? kMostColumns : kFewColumns), iteration_(kernels, team, copy, clusters) {}

void SingleSolve::prepare() {
  iteration_.prepare();
  start_.prepare(copy_.order());
  largest_.assign(static_cast<std::size_t>(copy_.order().parts()), 0.0);
  for (Doubles* v : {&b_, &x_, &Ax_}) v->assign(4 * static_cast<std::size_t>(nodes()) + kVectorTail, 0.0);
}

SolveStatus SingleSolve::solve(const double* b, double* x, bool remember) {
  const int* node = copy_.order().node.data();
  team_.for_each([&](std::size_t part, int first, int last) {
    double largest = 0.0;
    for (int k = first; k < last; ++k) {
      const double* from = b + 3 * static_cast<std::ptrdiff_t>(node[k]);
      double* to = b_.data() + 4 * static_cast<std::ptrdiff_t>(k);
      for (int axis = 0; axis < 3; ++axis) {
        to[axis] = from[axis];
        largest = std::max(largest, std::abs(from[axis]));  // of what is no number nothing is said here
      }
    }
    largest_[part] = largest;
  });
  if (*std::max_element(largest_.begin(), largest_.end()) == 0.0 && std::all_of(b_.begin(), b_.end(), [](double value) { return value == 0.0; })) {
    std::fill_n(x, 3 * nodes(), 0.0);
    return SolveStatus::kOk;
  }
  held_.clear();
  for (const std::size_t entry : copy_.held()) held_.push_back(std::exchange(b_[entry], 0.0));
  if (const SolveStatus status = iterate(remember); status != SolveStatus::kOk) return status;
  const double largest = put_solution(x);
  for (std::size_t h = 0; h < held_.size(); ++h) {  // rows of the identity
    const std::size_t entry = copy_.held()[h];
    x[3 * static_cast<std::size_t>(node[entry / 4]) + entry % 4] = held_[h];
  }
  if (remember) {
    if (copy_.balanced()) follow_product();  // a next step may be solved by this matrix
    start_.keep(x_, largest, copy_.scale(), copy_.balanced() ? &Ax_ : nullptr);
  }
  return SolveStatus::kOk;
}

double SingleSolve::put_solution(double* x) {
  const int* node = copy_.order().node.data();
  team_.for_each([&](std::size_t part, int first, int last) {
    double largest = 0.0;
    for (int k = first; k < last; ++k) {
      const double* from = x_.data() + 4 * static_cast<std::ptrdiff_t>(k);
      double* to = x + 3 * static_cast<std::ptrdiff_t>(node[k]);
      for (int axis = 0; axis < 3; ++axis) {
        to[axis] = from[axis];
        largest = std::max(largest, std::abs(from[axis]));
      }
    }
    largest_[part] = largest;
  });
  return *std::max_element(largest_.begin(), largest_.end());
}

SolveStatus SingleSolve::iterate(bool warm) {
  if (warm && start_.count() > 0 && !start_.products_known()) {
    copy_.multiply(start_.count(), start_.solutions(), start_.products());
    start_.products_are_known(true);
  }
  const KrylovStart::Start start = start_.combine(warm, copy_.scale(), b_, x_, Ax_);
  size_ = start.residual;
  if (!std::isfinite(size_)) return SolveStatus::kNotConverged;
  if (size_ == 0.0) return SolveStatus::kOk;
  set_residual();
  iteration_.begin(start.energy);
  if (const SolveStatus status = refine(); status != SolveStatus::kOk) return status;
  iteration_.end();
  correction_ = std::sqrt((start.change + iteration_.solution() - start.energy) / iteration_.solution());
  return SolveStatus::kOk;
}

SolveStatus SingleSolve::refine() {
  double rho = iteration_.precondition();
  // Of a first solve the spectrum is not known: the residual's own norm goes ten times below what is asked.
  iteration_.set_floor(iteration_.first() ? 0.01 * rtol_ * rtol_ * rho * unit() : HUGE_VAL);
  const double unchecked = iteration_.first() ? HUGE_VAL : kReductionUnchecked * kReductionUnchecked * rho * unit();
  iteration_.forget_direction();
  iteration_.clear_correction();
  double conjugate = 0.0;
  int left = kIterationLimit;
  for (int replacement = 0; replacement < kResidualReplacements; ++replacement) {
    if (!std::isfinite(rho)) return SolveStatus::kNotConverged;
    if (iteration_.reached(rho * unit(), rtol_)) return SolveStatus::kOk;
    int steps = 0;
    const SolveStatus status = iteration_.reduce(rho, conjugate, kReductionInSingle * kReductionInSingle * rho, unit(), rtol_, left, steps);
    left -= steps;
    counters_.iterations += steps;
    if (status != SolveStatus::kOk) return status;
    const bool done = iteration_.reached(rho * unit(), rtol_);
    const double size_before = size_;
    add_correction();
    if (done && replacement == 0 && rho * unit() >= unchecked && rtol_ >= kTrustsSingleStart) return SolveStatus::kOk;
    copy_.multiply(x_, Ax_);
    ++counters_.iterations;
    size_ = norm_of_residual();
    if (size_ == 0.0) return SolveStatus::kOk;
    set_residual();
    const bool moved = iteration_.minimise_along_last();
    rho = iteration_.precondition();
    if (iteration_.reached(rho * unit(), rtol_)) {
      if (moved) add_correction();
      return SolveStatus::kOk;
    }
    if (size_ > 0.5 * size_before && replacement > 0) return at_rounding() ? SolveStatus::kOk : SolveStatus::kNotConverged;
    conjugate = iteration_.orthogonal_to_last();
  }
  return SolveStatus::kNotConverged;
}

/// No digit more can be had: the residual is what rounding of its own terms leaves.
bool SingleSolve::at_rounding() const {
  const auto norm = [](const Doubles& v) { return Eigen::Map<const VecX>(v.data(), static_cast<Eigen::Index>(v.size())).norm(); };
  return size_ <= 1e-14 * (norm(b_) + norm(x_) / copy_.scale());
}

void SingleSolve::set_residual() {
  const double by = 1.0 / size_;
  team_.for_each([&](std::size_t, int first, int last) { kernels_.residual(by, b_.data(), Ax_.data(), iteration_.residual().data(), first, last); });
}
double SingleSolve::norm_of_residual() const {
  double square = 0.0;
  for (std::size_t i = 0; i < b_.size(); ++i) square += (b_[i] - Ax_[i]) * (b_[i] - Ax_[i]);
  return std::sqrt(square);
}

void SingleSolve::add_correction() {
  const double by = copy_.scale() * size_;
  team_.for_each([&](std::size_t, int first, int last) { kernels_.correct(by, iteration_.correction().data(), x_.data(), first, last); });
  iteration_.clear_correction();
}

void SingleSolve::follow_product() {
  const float* r = iteration_.residual().data();
  team_.for_each([&](std::size_t, int first, int last) {
    for (std::size_t k = 4 * static_cast<std::size_t>(first); k < 4 * static_cast<std::size_t>(last); ++k) Ax_[k] = b_[k] - size_ * static_cast<double>(r[k]);
  });
}

}  // namespace palpate::integrate
