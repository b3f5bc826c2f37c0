#include "linear/mixed_precision/single_solve.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::linear {

using dynamics::SolveStatus;

namespace {
/// A solve to no more than this reduction needs no final residual check in double.
constexpr double kReductionUnchecked = 1e-3;
/// Products of the initial guess are in single precision: their rounding error, some 1e-7 of the solution in
/// the energy norm, is far below this tolerance.
constexpr double kTrustsSingleStart = 1e-5;
constexpr int kResidualReplacements = 40;
}  // namespace

void SingleSolve::prepare() { Ax_.assign(4 * static_cast<std::size_t>(s_.nodes()) + kVectorTail, 0.0); }

void SingleSolve::begin(bool warm) {
  if (warm && s_.guess.count() > 0 && !s_.guess.products_known()) {
    s_.copy.multiply(s_.guess.count(), s_.guess.solutions(), s_.guess.products());
    s_.guess.products_are_known(true);
  }
  s_.begin(warm);
}

/// Returns false where b is zero.
/// @param guess  Whether to add up the sums that the initial guess needs.
bool SingleSolve::take_right_hand_side(const double* b, bool guess) {
  held_.resize(s_.copy.held().size());
  const int* node = s_.copy.order().node.data();
  s_.team.for_each([&](std::size_t part, int first, int last) {
    double most = 0.0;
    for (int k = first; k < last; ++k) {
      const double* from = b + 3 * static_cast<std::ptrdiff_t>(node[k]);
      double* to = s_.b.data() + 4 * static_cast<std::ptrdiff_t>(k);
      for (int axis = 0; axis < 3; ++axis) {
        to[axis] = from[axis];
        most = std::max(most, std::abs(from[axis]));  // values that are not finite are detected below
      }
    }
    s_.largest[part] = most;
    s_.copy.take_held(part, s_.b.data(), held_.data());
    if (guess) s_.guess.add_up(part, s_.b.data(), first, last);
  });
  return *std::max_element(s_.largest.begin(), s_.largest.end()) != 0.0 ||
         std::any_of(s_.b.begin(), s_.b.end(), [](double value) { return !(value == 0.0); });
}

void SingleSolve::put_solution(double* x, bool remember, bool follow) {
  s_.put_solution(x, remember, follow);
  const int* node = s_.copy.order().node.data();
  for (std::size_t h = 0; h < held_.size(); ++h) {  // rows of the identity
    const std::size_t entry = s_.copy.held()[h];
    x[3 * static_cast<std::size_t>(node[entry / 4]) + entry % 4] = held_[h];
  }
}

SolveStatus SingleSolve::solve(const double* b, double* x, bool remember) {
  begin(remember);
  if (!take_right_hand_side(b, true)) {
    std::fill_n(x, 3 * s_.nodes(), 0.0);
    return SolveStatus::kOk;
  }
  if (const SolveStatus status = iterate(); status != SolveStatus::kOk) return status;
  put_solution(x, remember, s_.copy.zero_row_sum());  // the next step may use a zero-row-sum matrix
  return SolveStatus::kOk;
}

SolveStatus SingleSolve::approach(const double* b, double* x, bool again, double share, bool& accurate) {
  if (!again) begin(true);
  if (!take_right_hand_side(b, !again)) return SolveStatus::kNotConverged;
  share_ = share;
  SolveStatus status;
  if (again) {
    renew_residual();
    s_.iteration.restart();
    double energy = 0.0;
    for (std::size_t i = 0; i < s_.x.size(); ++i) energy += s_.x[i] * Ax_[i];
    status = s_.size == 0.0 ? SolveStatus::kOk : iterate(energy, true);
  } else {
    status = iterate();
  }
  share_ = 0.0;
  if (status != SolveStatus::kOk) return status;
  accurate = accurate_ || s_.size == 0.0;
  put_solution(x, false, false);
  return SolveStatus::kOk;
}

SolveStatus SingleSolve::iterate() {
  const ProjectedGuess::Start start = s_.choose();
  if (const SolveStatus status = iterate(start.energy, false); status != SolveStatus::kOk) return status;
  s_.correction =
      std::sqrt((start.change + s_.iteration.solution() - start.energy) / s_.iteration.solution());
  return SolveStatus::kOk;
}

/// Iterates from the current guess.
/// @param start  Energy of the start.
SolveStatus SingleSolve::iterate(double start, bool residual_is_set) {
  if (!std::isfinite(s_.size)) return SolveStatus::kNotConverged;
  s_.iteration.begin(start);
  s_.iteration.allow(allowed_);
  s_.iteration.allow_share(share_);
  double rho = s_.iteration.precondition([&](int first, int last) {
    if (!residual_is_set) s_.set_residual(first, last);
  });
  const SolveStatus status = refine(rho);
  accurate_ = status == SolveStatus::kOk && s_.iteration.accurate(rho * s_.unit(), s_.rtol);
  s_.iteration.allow(0.0);
  s_.iteration.allow_share(0.0);
  if (status == SolveStatus::kOk) s_.iteration.end();
  return status;
}

/// @param rho  In: r . P^-1 r of the residual that is set; out: value at the end.
SolveStatus SingleSolve::refine(double& rho) {
  // In the first solve the spectrum is unknown: the preconditioned residual norm must fall to a tenth of the
  // tolerance.
  s_.iteration.set_floor(s_.iteration.first() ? 0.01 * s_.rtol * s_.rtol * rho * s_.unit() : HUGE_VAL);
  const double unchecked =
      s_.iteration.first() ? HUGE_VAL : kReductionUnchecked * kReductionUnchecked * rho * s_.unit();
  double conjugate = 0.0;
  int left = SolveState::kIterationLimit;
  for (int replacement = 0; replacement < kResidualReplacements; ++replacement) {
    if (!std::isfinite(rho)) return SolveStatus::kNotConverged;
    if (s_.iteration.reached(rho * s_.unit(), s_.rtol)) return SolveStatus::kOk;
    int steps = 0;
    const SolveStatus status = s_.iteration.reduce(
        rho, conjugate, SolveState::kReductionInSingle * SolveState::kReductionInSingle * rho, s_.unit(),
        s_.rtol, left, steps);
    left -= steps;
    s_.counters.iterations += steps;
    if (status != SolveStatus::kOk) return status;
    const bool done = s_.iteration.reached(rho * s_.unit(), s_.rtol);
    const double size_before = s_.size;
    if (done && replacement == 0 && rho * s_.unit() >= unchecked && target_error() >= kTrustsSingleStart)
      return SolveStatus::kOk;
    renew_residual();
    if (s_.size == 0.0) return SolveStatus::kOk;
    s_.iteration.minimise_along_last();
    rho = s_.iteration.precondition([](int, int) {});
    if (s_.iteration.reached(rho * s_.unit(), s_.rtol)) return SolveStatus::kOk;
    if (s_.size > 0.5 * size_before && replacement > 0)
      return at_rounding() ? SolveStatus::kOk : SolveStatus::kNotConverged;
    conjugate = s_.iteration.orthogonal_to_last();
  }
  return SolveStatus::kNotConverged;
}

/// Returns the target relative error.
double SingleSolve::target_error() const {
  return std::max(s_.rtol, std::sqrt(allowed_ / s_.iteration.solution()));
}

/// Recomputes the residual b - A x in double, at the cost of about one iteration.
void SingleSolve::renew_residual() {
  s_.add_correction();
  s_.copy.multiply(s_.x, Ax_);
  ++s_.counters.iterations;
  double square = 0.0;
  for (std::size_t i = 0; i < s_.b.size(); ++i) square += (s_.b[i] - Ax_[i]) * (s_.b[i] - Ax_[i]);
  s_.size = std::sqrt(square);
  const double by = s_.size > 0.0 ? 1.0 / s_.size : 0.0;
  s_.team.for_each([&](std::size_t, int first, int last) {
    s_.kernels.residual(by, s_.b.data(), Ax_.data(), s_.iteration.residual().data(), first, last);
  });
}

/// Whether no further digit is possible: the residual is the rounding error of its terms.
bool SingleSolve::at_rounding() const {
  const auto norm = [](const Doubles& v) {
    return Eigen::Map<const VecX>(v.data(), static_cast<Eigen::Index>(v.size())).norm();
  };
  return s_.size <= 1e-14 * (norm(s_.b) + norm(s_.x) / s_.copy.scale());
}

}  // namespace palpate::linear
