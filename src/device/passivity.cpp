#include "palpate/device/passivity.h"
#include "palpate/core/named_enum.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/device/profile.h"

// The observer's sum as a test of passivity. Let the loop be a wall, F = -K x - B (x_k - x_{k-1})/T, with D_k
// = x_k - x_{k-1} and n ticks of delay. Then, for B = 0 or n = 0 (src/haptic_stability/haptic_theory.cpp),
//     sum -F_{k-1-n} D_k + b D_k^2/T  >=  K/2 (x_N^2 - x_0^2) + (b/T - (2n + 1) K/2 - |B|/T) sum D_k^2,
// which is not negative for x_0 = 0 and b > (2n + 1) K T/2 + |B|. Without delay a triangle wave of period 2T
// and amplitude A attains the bound: one cycle changes the sum by (8 A^2/T)(b - K T/2 - B).
//
// Guarantee of the controller under a delay of n ticks. At tick k the energy E_k is known, the wrenches f_1
// ... f_n of the next n ticks have been sent, and c is sent for the tick after them. For displacements d_1
// ... d_{n+1} in these ticks
//     E_{k+n+1} = E_k + sum_i (-f_i d_i + b d_i^2/T) - c d_{n+1} + b d_{n+1}^2/T.
// Let W be its minimum over all d_i in boxes B_i, and W_0 the minimum of E_{k+n}, without c. c is the largest
// fraction of the requested wrench with W >= min(0, W_0). c = 0 always satisfies this, as friction never
// takes energy from the sum. E >= 0 then follows by induction for every motion within the boxes. After a
// motion beyond them the energy may be below zero, and then only wrenches pass that take energy from all
// motions within the boxes. A damper, in contrast, would have to push against a motion that has ended by the
// time it acts: delayed by n ticks it drives a vibration, once the delay exceeds a quarter of the period. A
// loop that is passive by the bound above keeps E >= 0 for every motion, so W >= 0 for any boxes, and it is
// not modified.
//
// The boxes. Over a tick the displacement changes by T^2 times the acceleration. A change of the motors'
// wrench since the last tick contributes at most T^2 |f_i - f_0|/m, with m the mass of the device alone: a
// hand that holds the device reduces it. The rest is due to the hand, and bounded by a_k:
//     B_i:  d_i = D_k +- sum_{j<=i} (a_k + T^2 |f_j - f_0|/m).
// a_k is derived from the motion of the handle in at least the last 4 H ticks, H = n + 1. For x = sin(wt) and
// a window W with w W <= pi the largest |x''| in the window is at least sin(wW/2), and in the H ticks after
// it at most sin(w(W/2 + H)): larger by the factor 1 + 2 H/W. So 3/2 times the maximum over W = 4 H covers
// every sinusoid of any frequency. x'' is computed from neighbouring ticks and from positions H ticks apart:
// for positions in steps r, rounding can contribute 2 r to the former and 2 r/H^2 to the latter, which is
// subtracted. Steps that rounding adds to a motion within the boxes cost at most |f| r: their sum is within
// r.

namespace palpate::device {

void PassivityObserver::sample(double t, const Pose& handle) {
  dt_ = started_ ? t - time_ : 0.0;
  change_ = started_ ? pose_difference(last_, handle) : Vec6(Vec6::Zero());
  const double in = -held_.force.dot(change_.tail<3>()) - held_.moment.dot(change_.head<3>());
  energy_ += in;
  if (dt_ > 0.0) energy_ += friction(change_, dt_);
  work_ += std::abs(in);
  least_ = std::min(least_, energy_);
  last_ = handle;
  time_ = t;
  started_ = true;
}

// Positions read in steps r have an error of r/2 at most, their difference over a tick an error of r.
double PassivityObserver::friction(const Vec6& change, double dt) const {
  return damping_ * (change.tail<3>().array().abs() - resolution_).cwiseMax(0.0).square().sum() / dt;
}

// Convex along each axis: the minimum is at -f + 2 b (|d| - r) sgn(d)/dt = 0, or at the nearer end.
double PassivityObserver::least_change(const Wrench& wrench, const Vec6& low, const Vec6& high,
                                       double dt) const {
  Vec6 f;
  f << wrench.moment, wrench.force;
  Vec6 d;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const bool turns = i < 3;
    const double free = f[i] == 0.0                ? 0.0
                        : turns || damping_ == 0.0 ? HUGE_VAL
                                                   : resolution_ + std::abs(f[i]) * dt / (2.0 * damping_);
    d[i] = std::clamp(std::copysign(free, f[i]), low[i], high[i]);
  }
  return -f.dot(d) + friction(d, dt);
}

void PassivityObserver::archive(Archive& a) {
  a("energy", energy_);
  a("least", least_);
  a("work", work_);
  a("time", time_);
  a("tick", dt_);
  a("started", started_);
  a("last", last_);
  a("change", change_);
}

AccelerationBound::AccelerationBound(int horizon, const Vec6& rounding)
    : horizon_(horizon),
      rounding_(rounding),
      positions_(2 * static_cast<std::size_t>(horizon) + 1, Vec6::Zero()) {
  largest_.fill(Vec6::Zero());
}

void AccelerationBound::add(const Vec6& change) {
  if (count_ > 0 && count_ % horizon_ == 0) {
    std::shift_right(largest_.begin(), largest_.end(), 1);
    largest_.front().setZero();
  }
  const auto at = [&](long tick) -> Vec6& {  // before the first tick the handle is at rest
    return positions_[static_cast<std::size_t>(tick + 2 * horizon_) % positions_.size()];
  };
  position_ += change;
  at(count_) = position_;
  const auto beyond_rounding = [&](const Vec6& difference) {
    return Vec6((difference.cwiseAbs() - 2.0 * rounding_).cwiseMax(0.0));
  };
  const Vec6 near = beyond_rounding(change - last_),
             far = beyond_rounding(position_ - 2.0 * at(count_ - horizon_) + at(count_ - 2 * horizon_));
  largest_.front() =
      largest_.front().cwiseMax(near).cwiseMax(far / (static_cast<double>(horizon_) * horizon_));
  last_ = change;
  ++count_;
}

Vec6 AccelerationBound::value() const {
  Vec6 out = Vec6::Zero();
  for (const Vec6& one : largest_) out = out.cwiseMax(one);
  return 1.5 * out;
}

void AccelerationBound::archive(Archive& a) {
  a("count", count_);
  a("position", position_);
  a("last", last_);
  a.rows("positions", positions_, [](auto&& f, Vec6& one) {
    for (double& value : one) f(value);
  });
  a.rows("largest", largest_, [](auto&& f, Vec6& one) {
    for (double& value : one) f(value);
  });
}

void PassivityController::archive(Archive& a) {
  a("dissipated", dissipated_);
  a("active", active_);
  a("observer", observer_);
  a("bound", bound_);
  a("reductions", reductions_);
}

PassivityController::Mode PassivityController::mode_of(const std::string& name) {
  if (const auto mode = value_named<Mode>(name)) return *mode;
  fail("passivity: unknown mode \"{}\"{}", name, suggestion(name, names_of_options<Mode>()));
}

namespace {

Vec6 of_axes(double turning, double moving) {
  Vec6 out;
  out << Vec3::Constant(turning), Vec3::Constant(moving);
  return out;
}

Vec6 stacked(const Wrench& wrench) {
  Vec6 out;
  out << wrench.moment, wrench.force;
  return out;
}

Wrench times(double share, const Wrench& wrench) { return {share * wrench.moment, share * wrench.force}; }

}  // namespace

PassivityController::PassivityController(Mode mode, const Figures& figures)
    : mode_(mode),
      figures_(figures),
      observer_(figures.damping, figures.resolution),
      bound_(1 + static_cast<int>(std::ceil(figures.delay / figures.tick - 1e-9)),
             of_axes(figures.angular_resolution, figures.resolution)),
      reductions_({.delay = figures.delay}) {}

Wrench PassivityController::apply(double t, const Pose& handle, const Motors& motors, const Wrench& limited,
                                  bool valid) {
  if (mode_ == Mode::kOff) return limited;
  observer_.hold(motors.mean());
  observer_.sample(t, handle);
  bound_.add(observer_.last_change());
  reductions_.advance(t);
  dissipated_ -= stacked(reductions_.mean()).dot(observer_.last_change());
  double share = 1.0;
  if (mode_ == Mode::kControl && valid && observer_.last_tick() > 0.0) share = largest_share(motors, limited);
  active_ += share < 1.0;
  const Wrench out = share < 1.0 ? times(share, limited) : limited;
  reductions_.send(t, times(share - 1.0, limited));
  return out;
}

double PassivityController::largest_share(const Motors& motors, const Wrench& limited) const {
  const double T = observer_.last_tick();
  const Vec6 change = observer_.last_change(), bound = bound_.value(), held = stacked(motors.mean()),
             by_motors = of_axes(T * T / figures_.rotational_inertia, T * T / figures_.mass);
  // Contribution of a span of `ticks` to the half width of the boxes, and the least change of the energy over
  // it.
  const auto widened = [&](const Wrench& wrench, double ticks) {
    return Vec6(ticks * (bound + by_motors.cwiseProduct((stacked(wrench) - held).cwiseAbs())));
  };
  const auto least = [&](const Wrench& wrench, const Vec6& half, double ticks) {
    return observer_.least_change(wrench, ticks * (change - half), ticks * (change + half), ticks * T);
  };
  double energy = observer_.energy();
  Vec6 half = Vec6::Zero();
  motors.coming([&](const Motors::Span& span) {
    const double ticks = (span.to - span.from) / T;
    half += widened(span.wrench, ticks);
    energy += least(span.wrench, half, ticks);
  });
  const auto passes = [&](double share) {
    const Wrench sent = motors.shaped(times(share, limited));
    return std::max(energy, 0.0) + least(sent, half + widened(sent, 1.0), 1.0) >= 0.0;
  };
  if (passes(1.0)) return 1.0;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (passes(middle) ? low : high) = middle;
  }
  return low;
}

std::unique_ptr<PassivityController> make_passivity_controller(PassivityController::Mode mode,
                                                               const DeviceSpec& device, double tick_s) {
  if (mode == PassivityController::Mode::kOff) return nullptr;
  const DeviceFigures figures = figures_of(device);
  return std::make_unique<PassivityController>(
      mode, PassivityController::Figures{.damping = figures.damping,
                                         .resolution = figures.encoder_resolution,
                                         .angular_resolution = device.encoder_resolution_rad,
                                         .mass = figures.mass,
                                         .rotational_inertia = device.rotational_inertia_kg_m2,
                                         .delay = device.delay_s,
                                         .tick = tick_s});
}

}  // namespace palpate::device
