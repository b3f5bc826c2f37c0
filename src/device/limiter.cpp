#include "palpate/device/limiter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "device/check_range.h"
#include "palpate/core/error.h"
#include "palpate/device/device.h"
#include "palpate/device/spec.h"

namespace palpate::device {
namespace {

/// Smoothstep: 0 at x <= 0, 1 at x >= 1, C1.
double smoothstep(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

// With x = |v|/max, |v| becomes max x / (1 + x^6)^(1/6): smooth everywhere (even power), monotone, below max,
// and with a relative deviation of 1 - (1 + 2^-6)^(-1/6) = 0.26 % at half the maximum (tanh would deviate by
// 7.6 % there).
Vec3 saturate(const Vec3& v, double max) {
  if (max == 0.0) return Vec3::Zero();
  const double norm = v.stableNorm();
  const double x = norm / max;
  const double x6 = x <= 1.0 ? std::pow(x, 6) : std::pow(x, -6);
  const double scale = x <= 1.0 ? std::pow(1.0 + x6, -1.0 / 6.0) : std::pow(1.0 + x6, -1.0 / 6.0) / x;
  return scale * v;
}

/// Scales v back into the ball if rounding put it outside: the norm never exceeds the maximum, not even by
/// rounding.
Vec3 inside(const Vec3& v, double max) {
  const double norm = v.norm();
  return norm > max ? Vec3(v * (max / norm * (1.0 - 4.0 * std::numeric_limits<double>::epsilon()))) : v;
}

/// Returns the point on the way from `from` to `to`, at most `reach` from `from`.
Vec3 towards(const Vec3& from, const Vec3& to, double reach) {
  const Vec3 way = to - from;
  const double length = way.norm();
  return length > reach ? Vec3(from + (reach / length) * way) : to;
}

void check_slew(double slew, double max, const char* what) {
  const double least = kLeastSlew * max;
  if (!(slew >= least))
    fail("device: {} = {} is too small for a fall from {} to zero within 10 ms; use at least {}", what, slew,
         max, least);
}

}  // namespace

WrenchLimiter::WrenchLimiter(double max_force_n, double max_torque_n_m, double ramp_s,
                             double max_force_slew_n_s, double max_torque_slew_n_m_s)
    : max_force_(max_force_n),
      max_torque_(max_torque_n_m),
      ramp_(ramp_s),
      force_slew_(max_force_slew_n_s),
      torque_slew_(max_torque_slew_n_m_s) {
  check_range("max_force_n", max_force_, DeviceRanges::max_force_n);
  check_range("max_torque_n_m", max_torque_, DeviceRanges::max_torque_n_m);
  check_range("ramp_s", ramp_, DeviceRanges::ramp_s);
  check_slew(force_slew_, max_force_, "max_force_slew_n_s");
  check_slew(torque_slew_, max_torque_, "max_torque_slew_n_m_s");
}

void WrenchLimiter::confine(const Workspace& workspace, const Device& device) {
  workspace_ = workspace;
  device_ = workspace.is_bounded() ? &device : nullptr;
}

void WrenchLimiter::archive(Archive& a) {
  a("start", start_);
  a("last_valid", last_valid_);
  a("last_time", last_time_);
  a("last_length", last_dt_);
  a("stalled", stalled_);
  a("started", started_);
  a("live", live_);
  a("last", last_);
  a("held", held_);
  a("limited", limited_);
  a("rejected", rejected_);
  a("outside", outside_);
  a("without_pose", without_pose_);
}

void WrenchLimiter::restart() {
  if (!(ramp_ > 0.0)) return;
  live_ = false;
  last_ = {};
}

Wrench WrenchLimiter::limit(double t, const Wrench& requested, bool valid) {
  const bool good_time = std::isfinite(t) && (!started_ || t > last_time_);
  const bool good_wrench = requested.force.allFinite() && requested.moment.allFinite();
  if (!good_time || (valid && !good_wrench)) ++rejected_;
  if (!good_time) {
    stalled_ += last_dt_;
    return last_ = fall(last_time_ - last_valid_ + stalled_);
  }
  last_dt_ = started_ ? t - last_time_ : 0.0;
  last_time_ = t;
  stalled_ = 0.0;
  started_ = true;
  last_ = valid && good_wrench ? follow(t, last_dt_, requested) : fall(t - last_valid_);
  without_pose_ += !valid && !live_;
  return last_;
}

Wrench WrenchLimiter::follow(double t, double dt, const Wrench& requested) {
  if (!live_ || t - last_valid_ >= kFallTime) start_ = t;
  live_ = true;
  last_valid_ = t;
  if (requested.force.stableNorm() > max_force_ ||
      (max_torque_ > 0.0 && requested.moment.stableNorm() > max_torque_))
    ++limited_;
  const double inside_workspace = device_ ? workspace_.share(device_->position()) : 1.0;
  outside_ += inside_workspace < 1.0;
  const double ramp = (ramp_ > 0.0 ? smoothstep((t - start_) / ramp_) : 1.0) * inside_workspace;
  held_.force = inside(towards(last_.force, ramp * saturate(requested.force, max_force_), force_slew_ * dt),
                       max_force_);
  held_.moment = inside(
      towards(last_.moment, ramp * saturate(requested.moment, max_torque_), torque_slew_ * dt), max_torque_);
  return held_;
}

Wrench WrenchLimiter::fall(double age) {
  live_ = live_ && age < kFallTime;
  if (!live_) return {};
  const double left = 1.0 - smoothstep((age - kHoldTime) / (kFallTime - kHoldTime));
  return {left * held_.moment, left * held_.force};
}

}  // namespace palpate::device
