#include "linear/mixed_precision/single_solve.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::linear {

using dynamics::SolveStatus;

namespace {
/// A solve that asks for no more than this reduction needs no look at the residual in double at its end.
constexpr double kReductionUnchecked = 1e-3;
/// Products of the start are in single precision: what rounding leaves of them, some 1e-7 of the solution in
/// the energy norm, is far below such a tolerance.
constexpr double kTrustsSingleStart = 1e-5;
constexpr int kResidualReplacements = 40;
/// Solutions to start from: many for tight tolerances, few for others, where one more saves less in
/// iterations than it costs.
constexpr double kManyStarts = 1e-4;
constexpr int kFewColumns = 3;
}  // namespace

SingleSolve::SingleSolve(const NodeKernels& kernels, ClusterTeam& team, SingleMatrix& copy,
                         const RigidClusters& clusters, double rtol, dynamics::SolverCounters& counters)
    : kernels_(kernels),
      team_(team),
      copy_(copy),
      rtol_(rtol),
      counters_(counters),
      start_(kernels, rtol < kManyStarts ? kMostColumns : kFewColumns),
      iteration_(kernels, team, copy, clusters) {}

void SingleSolve::prepare() {
  iteration_.prepare();
  start_.prepare(copy_.order());
  largest_.assign(static_cast<std::size_t>(copy_.order().parts()), 0.0);
  for (Doubles* v : {&b_, &x_, &Ax_}) v->assign(4 * static_cast<std::size_t>(nodes()) + kVectorTail, 0.0);
}

SolveStatus SingleSolve::solve(const double* b, double* x, bool remember) {
  if (remember && start_.count() > 0 && !start_.products_known()) {
    copy_.multiply(start_.count(), start_.solutions(), start_.products());
    start_.products_are_known(true);
  }
  begin(remember);
  held_.resize(copy_.held().size());
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
    copy_.take_held(part, b_.data(), held_.data());
    start_.add_up(part, b_.data(), first, last);
  });
  if (*std::max_element(largest_.begin(), largest_.end()) == 0.0 &&
      std::all_of(b_.begin(), b_.end(), [](double value) { return value == 0.0; })) {
    std::fill_n(x, 3 * nodes(), 0.0);
    return SolveStatus::kOk;
  }
  if (const SolveStatus status = iterate(); status != SolveStatus::kOk) return status;
  put_solution(x, remember, copy_.balanced());      // a next step may be solved by a balanced matrix
  for (std::size_t h = 0; h < held_.size(); ++h) {  // rows of the identity
    const std::size_t entry = copy_.held()[h];
    x[3 * static_cast<std::size_t>(node[entry / 4]) + entry % 4] = held_[h];
  }
  return SolveStatus::kOk;
}

void SingleSolve::begin(bool warm) {
  at_hand_ = false;
  iteration_.restart();
  start_.begin(warm, copy_.scale());
}

KrylovStart::Start SingleSolve::choose() {
  const KrylovStart::Start start = start_.choose();
  size_ = start.size;
  return start;
}

const double* SingleSolve::solution(int first, int last, Block& block) const {
  if (at_hand_ && !iteration_.moved()) return x_.data() + 4 * static_cast<std::ptrdiff_t>(first);
  if (at_hand_)
    std::copy_n(x_.data() + 4 * static_cast<std::ptrdiff_t>(first), 4 * (last - first), block.data());
  else
    start_.solution(block.data(), first, last);
  if (iteration_.moved()) iteration_.correct(copy_.scale() * size_, block.data(), first, last);
  return block.data();
}

void SingleSolve::add_correction() {
  team_.for_each([&](std::size_t, int first, int last) {
    double* x = x_.data() + 4 * static_cast<std::ptrdiff_t>(first);
    if (!at_hand_) start_.solution(x, first, last);
    if (iteration_.moved()) iteration_.correct(copy_.scale() * size_, x, first, last);
  });
  at_hand_ = true;
  iteration_.clear_correction();
}

double SingleSolve::put_solution(double* x, bool keep, bool follow) {
  const int* node = copy_.order().node.data();
  if (keep) start_.begin_to_keep(copy_.scale(), follow);
  team_.for_each([&](std::size_t part, int begin, int end) {
    double largest = 0.0;
    over_blocks(begin, end, [&](int first, int last) {
      Block value, image;
      const double* from = solution(first, last, value);
      largest = std::max(largest, kernels_.put_nodes(node, from, x, first, last));
      if (!keep) return;
      if (follow) kernels_.image(size_, b_.data(), iteration_.residual().data(), image.data(), first, last);
      start_.keep(from, image.data(), first, last);
    });
    largest_[part] = largest;
  });
  const double largest = *std::max_element(largest_.begin(), largest_.end());
  if (keep) start_.end_to_keep(largest);
  return largest;
}

SolveStatus SingleSolve::iterate() {
  const KrylovStart::Start start = choose();
  if (!std::isfinite(size_)) return SolveStatus::kNotConverged;
  iteration_.begin(start.energy);
  if (const SolveStatus status = refine(); status != SolveStatus::kOk) return status;
  iteration_.end();
  correction_ = std::sqrt((start.change + iteration_.solution() - start.energy) / iteration_.solution());
  return SolveStatus::kOk;
}

SolveStatus SingleSolve::refine() {
  double rho = iteration_.precondition([&](int first, int last) { set_residual(first, last); });
  // Of a first solve the spectrum is not known: the residual's own norm goes ten times below what is asked.
  iteration_.set_floor(iteration_.first() ? 0.01 * rtol_ * rtol_ * rho * unit() : HUGE_VAL);
  const double unchecked =
      iteration_.first() ? HUGE_VAL : kReductionUnchecked * kReductionUnchecked * rho * unit();
  double conjugate = 0.0;
  int left = kIterationLimit;
  for (int replacement = 0; replacement < kResidualReplacements; ++replacement) {
    if (!std::isfinite(rho)) return SolveStatus::kNotConverged;
    if (iteration_.reached(rho * unit(), rtol_)) return SolveStatus::kOk;
    int steps = 0;
    const SolveStatus status = iteration_.reduce(
        rho, conjugate, kReductionInSingle * kReductionInSingle * rho, unit(), rtol_, left, steps);
    left -= steps;
    counters_.iterations += steps;
    if (status != SolveStatus::kOk) return status;
    const bool done = iteration_.reached(rho * unit(), rtol_);
    const double size_before = size_;
    if (done && replacement == 0 && rho * unit() >= unchecked && rtol_ >= kTrustsSingleStart)
      return SolveStatus::kOk;
    renew_residual();
    if (size_ == 0.0) return SolveStatus::kOk;
    iteration_.minimise_along_last();
    rho = iteration_.precondition([](int, int) {});
    if (iteration_.reached(rho * unit(), rtol_)) return SolveStatus::kOk;
    if (size_ > 0.5 * size_before && replacement > 0)
      return at_rounding() ? SolveStatus::kOk : SolveStatus::kNotConverged;
    conjugate = iteration_.orthogonal_to_last();
  }
  return SolveStatus::kNotConverged;
}

/// Of b - A x in double, at a price of about an iteration.
void SingleSolve::renew_residual() {
  add_correction();
  copy_.multiply(x_, Ax_);
  ++counters_.iterations;
  double square = 0.0;
  for (std::size_t i = 0; i < b_.size(); ++i) square += (b_[i] - Ax_[i]) * (b_[i] - Ax_[i]);
  size_ = std::sqrt(square);
  const double by = size_ > 0.0 ? 1.0 / size_ : 0.0;
  team_.for_each([&](std::size_t, int first, int last) {
    kernels_.residual(by, b_.data(), Ax_.data(), iteration_.residual().data(), first, last);
  });
}

/// No digit more can be had: the residual is what rounding of its own terms leaves.
bool SingleSolve::at_rounding() const {
  const auto norm = [](const Doubles& v) {
    return Eigen::Map<const VecX>(v.data(), static_cast<Eigen::Index>(v.size())).norm();
  };
  return size_ <= 1e-14 * (norm(b_) + norm(x_) / copy_.scale());
}

}  // namespace palpate::linear
