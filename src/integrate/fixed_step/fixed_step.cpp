#include "integrate/fixed_step/fixed_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/clock.h"
#include "core/counters.h"
#include "core/finite.h"
#include "integrate/settings.h"
#include "integrate/tuning.h"
#include "palpate/core/error.h"

namespace palpate::integrate {

using dynamics::StepAttempt;
using dynamics::StepResult;
using dynamics::StepStatus;

namespace {

StepAttempt::Outcome outcome_of(StepStatus status) {
  switch (status) {
    case StepStatus::kOk: return StepAttempt::Outcome::kAccepted;
    case StepStatus::kNotFinite: return StepAttempt::Outcome::kNotFinite;
    default: return StepAttempt::Outcome::kNewton;
  }
}

}  // namespace

FixedStep::FixedStep(std::string name, int order, Between between, dynamics::System& system,
                     dynamics::State& state, const IntegratorSpec& spec)
    : system_(system),
      state_(state),
      spec_(spec),
      name_(std::move(name)),
      order_(order),
      clamped_before_(system.clamped_tangents()),
      between_(between) {
  check_fixed_step(spec_);
  counters::count("integrate." + name_);
}

double FixedStep::steps_in(double interval) const {
  return std::max(1.0, std::ceil(interval / spec_.step_s * (1.0 - tuning::kRoundingOfStep)));
}

/// Makes two attempts and discards their results: the linear solver "auto" chooses by its first matrix.
void FixedStep::prepare(double interval) {
  if (layout().u_size == 0) return;
  const double h = interval / steps_in(interval);
  q1_.resize(layout().q_size);
  u1_.resize(layout().u_size);
  for (int k = 0; k < 2; ++k) {
    attempt(h, state_.time() + h);
    forget(dynamics::ReinitReason::kStateChanged);
  }
}

StepResult FixedStep::advance_to(double t_end) {
  const double start = state_.time();
  PALPATE_CHECK(t_end > start, "t_end = {} must be later than t = {}", t_end, start);
  StepResult result;
  result.t = t_end;
  if (layout().u_size == 0) {  // No body: only time advances.
    state_.set_time(t_end);
    return result;
  }
  taken_ = 0;
  const double count = steps_in(t_end - start), h = (t_end - start) / count;
  for (double k = 1.0; state_.time() < t_end; ++k) {
    result = cover(k < count ? start + k * h : t_end, h, t_end);
    if (!result.ok()) return result;
    if (interrupted() && state_.time() < t_end) return failure(StepStatus::kInterrupted, h, 0, "interrupted");
  }
  return result;
}

/// Takes one step to t1, divided into parts where necessary.
StepResult FixedStep::cover(double t1, double h, double t_end) {
  int halvings = 0;
  for (double part = h;;) {
    if (halvings > 0 && interrupted()) return failure(StepStatus::kInterrupted, part, 0, "interrupted");
    if (taken_ == spec_.max_steps)
      return failure(StepStatus::kTooManySteps, part, 0,
                     fmt::format("reached max_steps = {} before t_end = {}", taken_, t_end));
    const bool last = halvings == 0 || t1 - state_.time() <= part * (1.0 + tuning::kRoundingOfStep);
    const double to = last ? t1 : state_.time() + part, length = halvings == 0 ? h : to - state_.time();
    q1_.resize(layout().q_size);
    u1_.resize(layout().u_size);
    Attempt tried = attempt(length, to);
    if (tried.status == StepStatus::kOk && !(all_finite(q1_) && all_finite(u1_)))
      tried = {.status = StepStatus::kNotFinite, .what = "the position or the velocity is not finite"};
    counters_.newton_iterations += tried.iterations;
    if (trace()) tell(tried, length, to, halvings);
    if (tried.status != StepStatus::kOk) {
      ++counters_.rejected;
      if (tried.status == StepStatus::kNewtonFailed) ++counters_.newton_failures;
      if (!tried.recoverable) return failure(tried.status, length, tried.iterations, tried.what);
      if (halvings == 0) ++counters_.halved_steps;
      if (++halvings > tuning::kHalvings)
        return failure(
            tried.status, length, tried.iterations,
            fmt::format("{}, even with the step reduced to h/{}", tried.what, 1 << tuning::kHalvings));
      counters_.most_halvings = std::max<long>(counters_.most_halvings, halvings);
      part /= 2.0;
      continue;
    }
    if (halvings > 0) ++counters_.step_parts;
    accept(length, to);
    if (!last) continue;
    StepResult result;
    result.t = to;
    result.h = length;
    result.order = order_;
    result.iterations = tried.iterations;
    result.residual = tried.residual;
    return result;
  }
}

void FixedStep::accept(double h, double t1) {
  q0_ = state_.q();
  u0_ = state_.u();
  t0_ = state_.time();
  t1_ = t1;
  state_.q() = q1_;
  state_.u() = u1_;
  state_.set_time(t1);
  ++counters_.steps;
  ++taken_;
  accepted(h);
  if (follower_) follower_->stepped(*this, t0_, t1_);
}

void FixedStep::tell(const Attempt& attempt, double h, double t1, int halvings) const {
  StepAttempt record;
  record.t = state_.time();
  record.h = h;
  record.order = order_;
  record.error = std::numeric_limits<double>::quiet_NaN();
  record.newton_iterations = attempt.iterations;
  record.outcome = outcome_of(attempt.status);
  record.halvings = halvings;
  if (attempt.status != StepStatus::kOk && all_finite(q1_) && all_finite(u1_)) {
    const auto [diagnostic, term] = system_.inspect(state_.view(t1, q1_.data(), u1_.data()));
    record.inverted_element = diagnostic.element;
    record.inverted_in = term;
  }
  trace()->attempt(record);
}

StepResult FixedStep::failure(StepStatus status, double h, int iterations, const std::string& what) const {
  StepResult result;
  result.status = status;
  result.t = state_.time();
  result.h = h;
  result.order = order_;
  result.iterations = iterations;
  result.message = fmt::format("{}: {} (t = {}, h = {})", name_, what, state_.time(), h);
  return result;
}

bool FixedStep::acceleration(double t, const double* q, const double* u, VecX& a) {
  const ScopedTimer timer(counters_.force_s);
  ++counters_.force_evaluations;
  system_.acceleration(state_.view(t, q, u), a);
  return all_finite(a);
}

// Hermite's cubic, with s = (t - t0)/h: p = (1 - s)^2 (1 + 2s) x0 + s^2 (3 - 2s) x1 + h s (1 - s) ((1 - s)
// x0' - s x1'), and its rate p' = 6 s (1 - s) (x1 - x0)/h + (1 - s)(1 - 3s) x0' + s (3s - 2) x1'.
bool FixedStep::dense_output(double t, VecX& q, VecX& u) const {
  const dynamics::Layout& l = layout();
  if (q0_.size() != l.q_size || t < t0_ || t > t1_ || !(t1_ > t0_)) return false;
  const double h = t1_ - t0_, s = (t - t0_) / h, r = 1.0 - s;
  const auto q1 = state_.q(), u1 = state_.u();
  if (between_ == Between::kLinear) {
    q = r * q0_ + s * q1;
    u = r * u0_ + s * u1;
  } else {
    rate_.resize(l.q_size);
    rate1_.resize(l.q_size);
    dynamics::q_dot(l, q0_.data(), u0_.data(), rate_.data());
    dynamics::q_dot(l, q1.data(), u1.data(), rate1_.data());
    q = r * r * (1.0 + 2.0 * s) * q0_ + s * s * (3.0 - 2.0 * s) * q1 + h * s * r * (r * rate_ - s * rate1_);
    if (between_ == Between::kCubicWithAcceleration) {
      u = r * r * (1.0 + 2.0 * s) * u0_ + s * s * (3.0 - 2.0 * s) * u1 + h * s * r * (r * a0_ - s * a1_);
    } else {
      rate_ = (6.0 * s * r / h) * (q1 - q0_) + r * (1.0 - 3.0 * s) * rate_ + s * (3.0 * s - 2.0) * rate1_;
      u.resize(l.u_size);
      for (const dynamics::Block& b : l.blocks) {
        if (b.kinematics)
          b.kinematics->u_of_q_dot(q.segment(b.q_offset, b.q_size), rate_.segment(b.q_offset, b.q_size),
                                   u.segment(b.u_offset, b.u_size));
        else
          u.segment(b.u_offset, b.u_size) = rate_.segment(b.q_offset, b.q_size);
      }
    }
  }
  dynamics::project(l, q.data());
  system_.impose(l, t, q.data(), u.data());
  return true;
}

void FixedStep::reinit(dynamics::ReinitReason reason) {
  ++counters_.reinits;
  t1_ = t0_;
  forget(reason);
}

const dynamics::StepperCounters& FixedStep::counters() const {
  collect(counters_);
  counters_.clamped = system_.clamped_tangents() - clamped_before_;
  return counters_;
}

}  // namespace palpate::integrate
