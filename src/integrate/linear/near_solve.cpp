#include "integrate/linear/near_solve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "palpate/core/clock.h"

namespace palpate::integrate {

using dynamics::SolveStatus;

namespace {
/// How well what the copy's age left is solved for.
constexpr double kRoughly = 0.5;
/// Looks at what a matrix near the copy leaves, in one solve.
constexpr int kMostResiduals = 4;
}  // namespace

void NearSolve::prepare() {
  SingleSolve::prepare();
  before_.clear();
  age_ = MatrixAge(rtol_);
}

SolveStatus NearSolve::solve(const double* b, double* x, bool remember) {
  const SolveStatus status = SingleSolve::solve(b, x, remember);
  if (status == SolveStatus::kOk && remember) age_.solved(correction_);
  return status;
}

SolveStatus NearSolve::solve_near(dynamics::Residual& left, VecX& x) {
  if (!can_correct() || !start_.products_followed()) return SolveStatus::kNotConverged;
  const bool own = std::exchange(own_, false);
  if (!own && !age_.serves()) return SolveStatus::kNotConverged;
  const double start = wall_seconds();
  residuals_s_ = 0.0;
  x.resize(3 * nodes());
  const SolveStatus status = approach(left, x);
  counters_.solve_s += wall_seconds() - start - residuals_s_;
  if (status != SolveStatus::kOk) {
    if (!own) age_.failed();
    return status;
  }
  age_.solved(correction_);
  ++counters_.solves;
  if (!own) ++counters_.near;
  return status;
}

SolveStatus NearSolve::approach(dynamics::Residual& left, VecX& x) {
  start_.foresee(copy_.scale(), x_, Ax_);
  int residuals = 1;
  look(left, x);
  const KrylovStart::Start start = start_.combine(true, copy_.scale(), b_, x_, Ax_);
  size_ = start.residual;
  double energy = start.energy, change = start.change;
  const double by_copy = (1.0 - MatrixAge::kUnseen) * rtol_;
  for (;;) {
    if (!std::isfinite(size_)) return SolveStatus::kNotConverged;
    set_residual();
    double open = 0.0;
    if (const SolveStatus status = descend(energy, by_copy, open); status != SolveStatus::kOk) return status;
    const double solution = iteration_.solution(), correction = std::sqrt((change + solution - energy) / solution);
    follow_product();
    if (residuals == 1) correction_ = correction;
    if (open <= by_copy && !rounded_ && age_.sure(correction)) break;
    if (residuals == kMostResiduals) return SolveStatus::kNotConverged;
    before_.resize(b_.size());
    std::swap(b_, before_);
    look(left, x);
    ++residuals;
    double stale = 0.0;
    if (const SolveStatus status = mend(solution, stale, open); status != SolveStatus::kOk) return status;
    age_.seen(stale, correction);
    if (open <= rtol_) break;
    if (!MatrixAge::converges(stale, correction)) return SolveStatus::kNotConverged;
    size_ = norm_of_residual();
    energy = solution;
    change = stale * stale * solution;
  }
  iteration_.end();
  start_.keep(x_, put_solution(x.data()), copy_.scale(), &Ax_);
  counters_.residuals += residuals;
  return SolveStatus::kOk;
}

/// b_ = what A leaves of x_, and Ao x_.
void NearSolve::look(dynamics::Residual& left, VecX& x) {
  put_solution(x.data());
  const double start = wall_seconds();
  left.at(x, residual_);
  residuals_s_ += wall_seconds() - start;
  const int* node = copy_.order().node.data();
  team_.for_each([&](std::size_t, int first, int last) {
    for (int k = first; k < last; ++k) {
      const double* from = residual_.data() + 3 * static_cast<std::ptrdiff_t>(node[k]);
      const std::ptrdiff_t to = 4 * static_cast<std::ptrdiff_t>(k);
      for (std::ptrdiff_t axis = 0; axis < 3; ++axis) b_[static_cast<std::size_t>(to + axis)] = from[axis] + Ax_[static_cast<std::size_t>(to + axis)];
    }
  });
}

/// Takes off what the copy's age left: b_ - before_ = (Ao - A) (the last correction), of which a rough solution tells the size and most of itself.
/// @param stale  its size over the solution's  @param open  in: what the iteration left open; out: with what is left of this
SolveStatus NearSolve::mend(double solution, double& stale, double& open) {
  double square = 0.0;
  for (std::size_t i = 0; i < b_.size(); ++i) square += (b_[i] - before_[i]) * (b_[i] - before_[i]);
  if (!(square > 0.0)) return square == 0.0 ? SolveStatus::kOk : SolveStatus::kNotConverged;
  size_ = std::sqrt(square);
  const double by = 1.0 / size_;
  team_.for_each([&](std::size_t, int first, int last) { kernels_.residual(by, b_.data(), before_.data(), iteration_.residual().data(), first, last); });
  double rest = 0.0;
  if (const SolveStatus status = descend(0.0, kRoughly, rest); status != SolveStatus::kOk) return status;
  const double found = iteration_.solution();
  stale = std::sqrt(found * (1.0 + rest * rest) / solution);
  open += rest * std::sqrt(found / solution);
  const float* r = iteration_.residual().data();
  team_.for_each([&](std::size_t, int first, int last) {
    for (std::size_t k = 4 * static_cast<std::size_t>(first); k < 4 * static_cast<std::size_t>(last); ++k) Ax_[k] += b_[k] - before_[k] - size_ * static_cast<double>(r[k]);
  });
  return SolveStatus::kOk;
}

/// Iterates from the iteration's residual, of that size, until the error is below rtol of the solution, or single precision has no more to say.
/// @param start  as EnergyBound::begin  @param open  the error then, over the solution
SolveStatus NearSolve::descend(double start, double rtol, double& open) {
  iteration_.begin(start);
  iteration_.set_floor(HUGE_VAL);
  iteration_.forget_direction();
  iteration_.clear_correction();
  double rho = iteration_.precondition();
  if (!std::isfinite(rho)) return SolveStatus::kNotConverged;
  if (!iteration_.reached(rho * unit(), rtol)) {
    int steps = 0;
    const SolveStatus status = iteration_.reduce(rho, 0.0, kReductionInSingle * kReductionInSingle * rho, unit(), rtol, kIterationLimit, steps);
    counters_.iterations += steps;
    if (status != SolveStatus::kOk) return status;
    add_correction();
  }
  open = std::sqrt(iteration_.error(rho * unit()) / iteration_.solution());
  return SolveStatus::kOk;
}

}  // namespace palpate::integrate
