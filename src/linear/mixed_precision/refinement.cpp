#include "linear/mixed_precision/refinement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/clock.h"

namespace palpate::linear {

using dynamics::SolveStatus;

namespace {
/// Relative tolerance of the solve for the error due to the lagged matrix.
constexpr double kRoughly = 0.5;
/// Most residual evaluations per solve: with the matrix of an earlier step, for which a new one costs less
/// than more of them, and with the step's own.
constexpr int kMostResiduals = 4, kMostResidualsOfOwn = 8;
}  // namespace

void Refinement::prepare() {
  open_.assign(s_.b.size(), 0.0f);
  lag_ = LaggedMatrixPolicy(s_.rtol);
}

std::optional<SolveStatus> Refinement::solve(dynamics::ResidualFunction& equations, VecX& x) {
  if (!can_correct() || !s_.guess.products_followed()) return {};
  const bool own = std::exchange(own_, false);
  if (!own && !lag_.serves()) return {};
  const double start = wall_seconds();
  residuals_s_ = 0.0;
  x.resize(3 * s_.nodes());
  const SolveStatus status = approach(equations, own ? kMostResidualsOfOwn : kMostResiduals, x);
  s_.counters.solve_s += wall_seconds() - start - residuals_s_;
  if (status != SolveStatus::kOk) {
    if (!own) lag_.failed();
    return status;
  }
  lag_.solved(s_.correction);
  ++s_.counters.solves;
  if (!own) ++s_.counters.lagged;
  return status;
}

SolveStatus Refinement::approach(dynamics::ResidualFunction& equations, int most_residuals, VecX& x) {
  s_.begin(true);
  s_.put_solution(x.data());
  evaluate_residual(equations, x);
  int residuals = 1;
  const ProjectedGuess::Start start = begin_with_residual();
  if (!std::isfinite(s_.size)) return SolveStatus::kNotConverged;
  const double by_copy = (1.0 - LaggedMatrixPolicy::kUnseen) * s_.rtol;
  double open = 0.0, energy = start.energy, change = start.change;
  SolveStatus status =
      descend(energy, by_copy, allowed_, open, [&](int first, int last) { s_.set_residual(first, last); });
  for (;;) {
    if (status != SolveStatus::kOk) return status;
    const double solution = s_.iteration.solution(),
                 correction = std::sqrt((change + solution - energy) / solution);
    if (residuals == 1) s_.correction = correction;
    if (!(solution > 0.0)) break;  // both the right-hand side and the initial guess are zero
    if (open <= by_copy && !rounded_ && lag_.sure(correction)) break;
    if (residuals == most_residuals) return SolveStatus::kNotConverged;
    s_.add_correction();
    s_.put_solution(x.data());
    evaluate_residual(equations, x);
    ++residuals;
    double stale = 0.0;
    if (status = correct_lag(solution, stale, open); status != SolveStatus::kOk) return status;
    lag_.seen(stale, correction);
    if (open <= tolerance(solution)) break;
    if (!LaggedMatrixPolicy::converges(stale, correction)) return SolveStatus::kNotConverged;
    s_.add_correction();
    energy = solution;
    change = stale * stale * solution;
    status = descend(energy, by_copy, allowed_, open, [](int, int) {});
  }
  s_.iteration.end();
  s_.put_solution(x.data(), true, true);
  s_.counters.residual_checks += residuals;
  return SolveStatus::kOk;
}

double Refinement::tolerance(double solution) const {
  return std::max(s_.rtol, allowed_ / std::sqrt(solution));
}

void Refinement::evaluate_residual(dynamics::ResidualFunction& equations, VecX& x) {
  const double start = wall_seconds();
  equations.at(x, residual_);
  residuals_s_ += wall_seconds() - start;
}

/// b = (b - A x) + Ao x: right-hand side of the copy's system.
ProjectedGuess::Start Refinement::begin_with_residual() {
  const int* node = s_.copy.order().node.data();
  s_.team.for_each([&](std::size_t part, int first, int last) {
    double* b = s_.b.data() + 4 * static_cast<std::ptrdiff_t>(first);
    s_.guess.product(b, first, last);
    s_.kernels.add_nodes(node, residual_.data(), b, first, last);
    s_.guess.add_up(part, s_.b.data(), first, last);
  });
  return s_.choose();
}

/// Corrects the error due to Ao != A. residual_ is the residual with A; `size` times r of it is left by the
/// iteration, and the rest is (Ao - A) times the last correction. A rough solve for that rest yields its size
/// and removes most of it. Afterwards the iteration's residual is the sum of what both solves left.
/// @param stale  Out: size of the error due to the lagged matrix, relative to the solution.
/// @param open  In: relative error at the end of the iteration. Out: plus the remaining part of the stale
///   error.
SolveStatus Refinement::correct_lag(double solution, double& stale, double& open) {
  const int* node = s_.copy.order().node.data();
  float* r = s_.iteration.residual().data();
  double rest = 0.0;
  const SolveStatus status = descend(0.0, kRoughly, 0.0, rest, [&](int first, int last) {
    for (int k = first; k < last; ++k)
      for (int axis = 0; axis < 3; ++axis) {
        const std::size_t at = 4 * static_cast<std::size_t>(k) + static_cast<std::size_t>(axis);
        const double by_lag =
            residual_[3 * static_cast<std::ptrdiff_t>(node[k]) + axis] - s_.size * static_cast<double>(r[at]);
        open_[at] = r[at];
        s_.b[at] += by_lag;
        r[at] = static_cast<float>(by_lag / s_.size);
      }
  });
  if (status != SolveStatus::kOk) return status;
  const double found = s_.iteration.solution();
  stale = std::sqrt(found * (1.0 + rest * rest) / solution);
  open += rest * std::sqrt(found / solution);
  for (std::size_t i = 0; i < open_.size(); ++i) r[i] += open_[i];
  return SolveStatus::kOk;
}

/// Iterates from the residual that is set until the error is below rtol of the solution or below `absolute`,
/// or the reduction reaches the limit of single precision.
/// @param start  As EnergyBound::begin.
/// @param open  Out: remaining error relative to the solution.
template <class Set>
SolveStatus Refinement::descend(double start, double rtol, double absolute, double& open,
                                Set&& set_residual) {
  s_.iteration.begin(start);
  s_.iteration.allow(absolute * absolute);
  s_.iteration.set_floor(HUGE_VAL);
  s_.iteration.restart();
  double rho = s_.iteration.precondition(set_residual);
  open = 0.0;
  if (rho == 0.0) return SolveStatus::kOk;
  if (!std::isfinite(rho)) return SolveStatus::kNotConverged;
  if (!s_.iteration.reached(rho * s_.unit(), rtol)) {
    int steps = 0;
    const SolveStatus status =
        s_.iteration.reduce(rho, 0.0, SolveState::kReductionInSingle * SolveState::kReductionInSingle * rho,
                            s_.unit(), rtol, SolveState::kIterationLimit, steps);
    s_.counters.iterations += steps;
    if (status != SolveStatus::kOk) return status;
  }
  open = std::sqrt(s_.iteration.error(rho * s_.unit()) / s_.iteration.solution());
  return SolveStatus::kOk;
}

}  // namespace palpate::linear
