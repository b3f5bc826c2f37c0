#include "linear/mixed_precision/near_solve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "palpate/core/clock.h"

namespace palpate::linear {

using dynamics::SolveStatus;

namespace {
/// How well what the copy's age left is solved for.
constexpr double kRoughly = 0.5;
/// Looks at what a matrix near the copy leaves, in one solve.
constexpr int kMostResiduals = 4;
}  // namespace

void NearSolve::prepare() {
  SingleSolve::prepare();
  open_.assign(b_.size(), 0.0f);
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
  begin(true);
  put_solution(x.data());
  look(left, x);
  int residuals = 1;
  const KrylovStart::Start start = begin_where_it_leaves();
  if (!std::isfinite(size_)) return SolveStatus::kNotConverged;
  const double by_copy = (1.0 - MatrixAge::kUnseen) * rtol_;
  double open = 0.0, energy = start.energy, change = start.change;
  SolveStatus status =
      descend(energy, by_copy, open, [&](int first, int last) { set_residual(first, last); });
  for (;;) {
    if (status != SolveStatus::kOk) return status;
    const double solution = iteration_.solution(),
                 correction = std::sqrt((change + solution - energy) / solution);
    if (residuals == 1) correction_ = correction;
    if (open <= by_copy && !rounded_ && age_.sure(correction)) break;
    if (residuals == kMostResiduals) return SolveStatus::kNotConverged;
    add_correction();
    put_solution(x.data());
    look(left, x);
    ++residuals;
    double stale = 0.0;
    if (status = mend(solution, stale, open); status != SolveStatus::kOk) return status;
    age_.seen(stale, correction);
    if (open <= rtol_) break;
    if (!MatrixAge::converges(stale, correction)) return SolveStatus::kNotConverged;
    add_correction();
    energy = solution;
    change = stale * stale * solution;
    status = descend(energy, by_copy, open, [](int, int) {});
  }
  iteration_.end();
  put_solution(x.data(), true, true);
  counters_.residuals += residuals;
  return SolveStatus::kOk;
}

/// What A leaves of x.
void NearSolve::look(dynamics::Residual& left, VecX& x) {
  const double start = wall_seconds();
  left.at(x, residual_);
  residuals_s_ += wall_seconds() - start;
}

/// b_ = what A leaves of x, and Ao x: the copy's own right-hand side.
KrylovStart::Start NearSolve::begin_where_it_leaves() {
  const int* node = copy_.order().node.data();
  team_.for_each([&](std::size_t part, int first, int last) {
    double* b = b_.data() + 4 * static_cast<std::ptrdiff_t>(first);
    start_.product(b, first, last);
    kernels_.add_nodes(node, residual_.data(), b, first, last);
    start_.add_up(part, b_.data(), first, last);
  });
  return choose();
}

/// Takes off what the copy's age left.  A leaves `left` of x, of which the iteration left size_ r open; the
/// rest is (Ao - A) (the last correction), of which a rough solution tells the size and most of itself.  The
/// iteration's residual is then what both left open.
/// @param stale  its size over the solution's  @param open  in: what the iteration left open; out: with
///   what is left of this
SolveStatus NearSolve::mend(double solution, double& stale, double& open) {
  const int* node = copy_.order().node.data();
  float* r = iteration_.residual().data();
  double rest = 0.0;
  const SolveStatus status = descend(0.0, kRoughly, rest, [&](int first, int last) {
    for (int k = first; k < last; ++k)
      for (int axis = 0; axis < 3; ++axis) {
        const std::size_t at = 4 * static_cast<std::size_t>(k) + static_cast<std::size_t>(axis);
        const double by_age =
            residual_[3 * static_cast<std::ptrdiff_t>(node[k]) + axis] - size_ * static_cast<double>(r[at]);
        open_[at] = r[at];
        b_[at] += by_age;
        r[at] = static_cast<float>(by_age / size_);
      }
  });
  if (status != SolveStatus::kOk) return status;
  const double found = iteration_.solution();
  stale = std::sqrt(found * (1.0 + rest * rest) / solution);
  open += rest * std::sqrt(found / solution);
  for (std::size_t i = 0; i < open_.size(); ++i) r[i] += open_[i];
  return SolveStatus::kOk;
}

/// Iterates from the residual that is set, until the error is below rtol of the solution, or single precision
/// has no more to say.
/// @param start  as EnergyBound::begin  @param open  the error then, over the solution
template <class Set>
SolveStatus NearSolve::descend(double start, double rtol, double& open, Set&& set_residual) {
  iteration_.begin(start);
  iteration_.set_floor(HUGE_VAL);
  iteration_.restart();
  double rho = iteration_.precondition(set_residual);
  open = 0.0;
  if (rho == 0.0) return SolveStatus::kOk;
  if (!std::isfinite(rho)) return SolveStatus::kNotConverged;
  if (!iteration_.reached(rho * unit(), rtol)) {
    int steps = 0;
    const SolveStatus status = iteration_.reduce(rho, 0.0, kReductionInSingle * kReductionInSingle * rho,
                                                 unit(), rtol, kIterationLimit, steps);
    counters_.iterations += steps;
    if (status != SolveStatus::kOk) return status;
  }
  open = std::sqrt(iteration_.error(rho * unit()) / iteration_.solution());
  return SolveStatus::kOk;
}

}  // namespace palpate::linear
