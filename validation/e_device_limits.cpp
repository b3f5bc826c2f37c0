#include <limits>
#include <random>

#include "cases.h"
#include "palpate/device/limiter.h"

// Problem: limits of the device force. Exact answer, a property instead of a formula: for any sequence of
// wrenches (a millionfold too large, not finite, with lost poses), force and torque are within their maximum
// and their slew rate, and are zero from 20 ms after the last valid tick. Measured: the largest of each over
// its bound, limit 0, for the slew rate 1e-9 (the tick is known to rounding of t).

namespace palpate::validation {
namespace {

constexpr double kForce = 3.3, kTorque = 0.2, kForceSlew = 600.0, kTorqueSlew = 40.0;

/// Returns the output of a program without such limits: the requested wrench, clipped by component if `clip`.
Wrench careless(const Wrench& requested, bool clip) {
  return clip ? Wrench{requested.moment.cwiseMax(-kTorque).cwiseMin(kTorque),
                       requested.force.cwiseMax(-kForce).cwiseMin(kForce)}
              : requested;
}

std::vector<Measurement> run(const std::string& fault) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vec = [&](double size) {
    return Vec3(size * uniform(rng), size * uniform(rng), size * uniform(rng));
  };
  double force = 0, slew = 0, after_loss = 0, t = 0, last_valid = -1;
  long not_finite = 0, silent = 0;
  Wrench before;
  device::WrenchLimiter limiter(kForce, kTorque, 0.01, kForceSlew, kTorqueSlew);
  for (int i = 0; i < 200000; ++i) {
    const double dt = 1e-3 * std::pow(3.0, uniform(rng));
    t += dt;
    Wrench requested{vec(kTorque * std::pow(10.0, 6 * uniform(rng))),
                     vec(kForce * std::pow(10.0, 6 * uniform(rng)))};
    const bool valid = (i / 50) % 3 != 0;
    if (uniform(rng) > 0.98 && fault != "componentwise-clip")
      requested.force.x() = std::numeric_limits<double>::quiet_NaN();
    if (valid && requested.force.allFinite()) last_valid = t;
    const Wrench out = fault == "no-limiter" ? careless(requested, false)
                       : fault == "componentwise-clip"
                           ? careless(requested, true)
                           : limiter.limit(t, requested, valid || fault == "no-timeout");
    not_finite += !(out.force.allFinite() && out.moment.allFinite());
    force = std::max({force, out.force.norm() / kForce, out.moment.norm() / kTorque});
    slew = std::max({slew, (out.force - before.force).norm() / (kForceSlew * dt),
                     (out.moment - before.moment).norm() / (kTorqueSlew * dt)});
    if (t - last_valid >= device::kFallTime) {
      after_loss = std::max(after_loss, out.force.norm() + out.moment.norm());
      ++silent;
    }
    before = out;
  }
  const auto over = [](double ratio) { return std::isfinite(ratio) ? std::max(0.0, ratio - 1.0) : ratio; };
  return {{.quantity = "ticks that sent a number not finite [count]",
           .computed = static_cast<double>(not_finite),
           .error = static_cast<double>(not_finite)},
          {.quantity = "largest force or torque / its maximum",
           .computed = force,
           .exact = 1.0,
           .error = over(force),
           .bar = 0.0},
          {.quantity = "largest slew / its bound",
           .computed = slew,
           .exact = 1.0,
           .error = over(slew),
           .bar = 1e-9,
           .note = "the tick is known to rounding of t"},
          {.quantity = "force + torque 20 ms after the last valid tick [N, N m]",
           .computed = after_loss,
           .error = silent > 1000 ? after_loss : NAN,
           .bar = 0.0}};
}

}  // namespace

ValidationCase device_limits() {
  return {.name = "device-limits",
          .section = "E",
          .summary =
              "200,000 random ticks: force, torque and slew never above their bounds, zero 20 ms after the "
              "last valid pose",
          .why = "the last stage before motors that act on a hand",
          .quick = true,
          .run = run,
          .faults = {{"no-limiter", "number not finite"},
                     {"componentwise-clip", "largest"},
                     {"no-timeout", "20 ms after"}}};
}

}  // namespace palpate::validation
