#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "palpate/core/error.h"
#include "palpate/device/limiter.h"

using namespace palpate;
using namespace palpate::device;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

Wrench wrench(const Vec3& force, const Vec3& moment = Vec3::Zero()) { return {moment, force}; }

/// Steady output for a constant request: the second tick, so that the slew limit has had time to act.
Wrench steady(double force, double max) {
  WrenchLimiter limiter(max, 1.0, 0.0);
  limiter.limit(0.0, wrench(Vec3(0, 0, force)), true);
  return limiter.limit(1.0, wrench(Vec3(0, 0, force)), true);
}

std::string message(double force, double torque, double ramp, double slew) {
  try {
    WrenchLimiter(force, torque, ramp, slew, kDefaultSlew * torque);
  } catch (const Error& e) { return e.what(); }
  return "";
}

}  // namespace

TEST(WrenchLimiter, identity_below_half_and_never_above) {
  double last = 0.0;
  int below = 0, above = 0;
  for (double x = 0.01; x < 1e6; x *= 1.07) {
    const double out = steady(x, 3.3).force.z();
    EXPECT_GE(out, last * (1.0 - 1e-14));  // monotone to rounding
    EXPECT_LE(out, 3.3);
    if (x <= 1.65) {
      EXPECT_NEAR(out / x, 1.0, 0.01);
      ++below;
    } else if (x > 33.0) {
      EXPECT_NEAR(out / 3.3, 1.0, 1e-5);
      ++above;
    }
    last = out;
  }
  EXPECT_GT(below, 50);
  EXPECT_GT(above, 50);
  EXPECT_LE(steady(std::numeric_limits<double>::max(), 3.3).force.norm(), 3.3);
}

TEST(WrenchLimiter, is_c1_at_the_maximum) {
  const auto slope = [](double x, double h) {
    return (steady(x + h, 1.0).force.z() - steady(x - h, 1.0).force.z()) / (2 * h);
  };
  for (double x : {0.9, 0.99, 1.0, 1.01, 1.1})
    EXPECT_NEAR(slope(x, 1e-4), std::pow(1.0 + std::pow(x, 6), -7.0 / 6.0), 1e-6);
}

TEST(WrenchLimiter, ramps_in_and_keeps_the_direction) {
  WrenchLimiter limiter(3.3, 0.2, 0.1);
  const Vec3 force(0.3, -0.4, 0.0);
  double last = 0.0;
  for (int i = 0; i <= 200; ++i) {
    const Wrench out = limiter.limit(5.0 + 1e-3 * i, wrench(force), true);
    EXPECT_GE(out.force.norm(), last - 1e-15);
    EXPECT_NEAR(out.force.cross(force).norm(), 0.0, 1e-15);
    if (i == 50) {
      EXPECT_NEAR(out.force.norm(), 0.25, 1e-6);  // smoothstep(1/2) = 1/2
    }
    last = out.force.norm();
  }
  EXPECT_NEAR(last, 0.5, 1e-5);
  EXPECT_EQ(limiter.limited_ticks(), 0);
}

TEST(WrenchLimiter, a_restart_ramps_in_from_zero) {
  WrenchLimiter limiter(3.3, 0.2, 0.1), none(3.3, 0.2, 0.0);
  for (int i = 0; i <= 200; ++i)
    for (WrenchLimiter* one : {&limiter, &none})
      one->limit(1e-3 * i, wrench(Vec3(0.5, 0, 0), Vec3(0, 0.02, 0)), true);
  limiter.restart();
  none.restart();
  double last = 0.0;
  for (int i = 201; i <= 301; ++i) {
    const Wrench out = limiter.limit(1e-3 * i, wrench(Vec3(0.5, 0, 0), Vec3(0, 0.02, 0)), true);
    if (i == 201) { EXPECT_EQ(out.force.norm() + out.moment.norm(), 0.0); }
    if (i == 251) { EXPECT_NEAR(out.force.norm(), 0.25, 1e-6); }
    EXPECT_GE(out.force.norm(), last);
    last = out.force.norm();
  }
  EXPECT_NEAR(last, 0.5, 1e-5);
  EXPECT_NEAR(none.limit(0.201, wrench(Vec3(0.5, 0, 0)), true).force.x(), 0.5, 1e-5) << "nobody holds it";
}

TEST(WrenchLimiter, holds_for_10_ms_after_the_last_valid_pose_and_is_zero_at_20) {
  WrenchLimiter limiter(3.3, 0.2, 0.0);
  Wrench live;
  for (int i = 0; i <= 10; ++i) live = limiter.limit(1e-3 * i, wrench(Vec3(2, 0, 0), Vec3(0, 0.1, 0)), true);
  EXPECT_NEAR(live.force.x(), 2.0, 0.02);
  // a new wrench that arrives with an invalid pose is ignored
  for (const double age : {0.0005, 0.004, 0.0099}) {
    const Wrench out = limiter.limit(0.01 + age, wrench(Vec3(-3, 1, 0)), false);
    EXPECT_EQ(out.force, live.force) << age;
    EXPECT_EQ(out.moment, live.moment) << age;
  }
  Wrench last = live;
  for (int i = 1; i < 20; ++i) {
    const double x = i / 20.0;
    const Wrench out = limiter.limit(0.02 + 0.01 * x, wrench(Vec3(2, 0, 0)), false);
    EXPECT_LT(out.force.norm(), last.force.norm());
    EXPECT_LT(out.moment.norm(), last.moment.norm());
    EXPECT_NEAR(out.force.x(), live.force.x() * (1.0 - x * x * (3.0 - 2.0 * x)), 1e-12);
    last = out;
  }
  for (int i = 0; i < 5; ++i) {
    const Wrench out = limiter.limit(0.03001 + 1e-3 * i, wrench(Vec3(2, 0, 0)), false);
    EXPECT_EQ(out.force.norm() + out.moment.norm(), 0.0);
  }
}

TEST(WrenchLimiter, a_nan_falls_to_zero_and_is_counted) {
  WrenchLimiter limiter(3.3, 0.2, 0.0);
  for (int i = 0; i <= 10; ++i) limiter.limit(1e-3 * i, wrench(Vec3(2, 0, 0)), true);
  int ticks = 0;
  for (int i = 11; i <= 40; ++i, ++ticks) {
    const Wrench out = limiter.limit(1e-3 * i, wrench(Vec3(i % 2 ? kNaN : kInf, 0, 0)), true);
    EXPECT_TRUE(out.force.allFinite());
    if (i > 30) { EXPECT_EQ(out.force.norm(), 0.0); }
  }
  EXPECT_EQ(limiter.rejected_ticks(), ticks);
  EXPECT_NEAR(limiter.limit(0.041, wrench(Vec3(1, 0, 0)), true).force.x(), 1.0, 1e-3);  // and recovers
}

TEST(WrenchLimiter, a_clock_that_stops_or_jumps_cannot_hold_a_force) {
  for (double bad : {0.01, 0.0, -1.0, kNaN, kInf}) {
    WrenchLimiter limiter(3.3, 0.2, 0.0);
    for (int i = 0; i <= 10; ++i) limiter.limit(1e-3 * i, wrench(Vec3(2, 0, 0)), true);
    double last = 3.3;
    for (int i = 1; i <= 21; ++i) {
      const double out = limiter.limit(bad, wrench(Vec3(2, 0, 0)), true).force.norm();
      EXPECT_LE(out, last);
      last = out;
    }
    EXPECT_EQ(last, 0.0) << bad;
    EXPECT_EQ(limiter.rejected_ticks(), 21);
    EXPECT_GT(limiter.limit(0.011, wrench(Vec3(2, 0, 0)), true).force.norm(), 1.0)
        << "lives again with the clock";
  }
}

// For any input the output is finite, within the maximum, with bounded slew, and zero from 20 ms after the
// last valid tick on.
TEST(WrenchLimiter, property_over_random_inputs) {
  std::mt19937 rng(20240611);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vec = [&](double scale) {
    return Vec3(scale * uniform(rng), scale * uniform(rng), scale * uniform(rng));
  };
  long checked = 0, silent = 0, slewing = 0;
  for (int run = 0; run < 50; ++run) {
    const double force = std::pow(10.0, 2 * uniform(rng)), torque = std::pow(10.0, 2 * uniform(rng));
    const double force_slew = force * 151.0 * (1.0 + std::abs(uniform(rng))), torque_slew = torque * 151.0;
    WrenchLimiter limiter(force, torque, std::abs(uniform(rng)) < 0.5 ? 0.0 : 0.05, force_slew, torque_slew);
    double t = uniform(rng), last_valid = -kInf;
    Wrench last;
    for (int i = 0; i < 4000; ++i) {
      const double dt = 1e-3 * std::pow(10.0, uniform(rng));
      t += dt;
      Wrench requested = wrench(vec(force * std::pow(10.0, 4 * uniform(rng))),
                                vec(torque * std::pow(10.0, 4 * uniform(rng))));
      bool valid = (i / 40) % 3 != 0 || uniform(rng) > 0.9;
      if (uniform(rng) > 0.98) requested.force[i % 3] = kNaN;
      if (uniform(rng) > 0.98) requested.moment[i % 3] = -kInf;
      if (valid && requested.force.allFinite() && requested.moment.allFinite()) last_valid = t;
      const Wrench out = limiter.limit(t, requested, valid);
      ASSERT_TRUE(out.force.allFinite() && out.moment.allFinite());
      ASSERT_LE(out.force.norm(), force);
      ASSERT_LE(out.moment.norm(), torque);
      // The clock is rounded: dt is known to eps t.
      const double room = 1e-9;
      if (i > 0) {
        ASSERT_LE((out.force - last.force).norm(), force_slew * dt * (1.0 + room));
        ASSERT_LE((out.moment - last.moment).norm(), torque_slew * dt * (1.0 + room));
        slewing += (out.force - last.force).norm() > 0.99 * force_slew * dt;
      }
      if (t - last_valid >= 0.020) {
        ASSERT_EQ(out.force.norm() + out.moment.norm(), 0.0);
        ++silent;
      }
      last = out;
      ++checked;
    }
    EXPECT_GT(limiter.limited_ticks(), 0);
    EXPECT_GT(limiter.rejected_ticks(), 0);
  }
  EXPECT_EQ(checked, 200000);
  EXPECT_GT(silent, 1000);
  EXPECT_GT(slewing, 1000);
}

// Three motors that move a tip: the torque that they cannot exert does not count as limited output.
TEST(WrenchLimiter, a_device_without_torque_gives_none) {
  WrenchLimiter limiter(3.3, 0.0, 0.0);
  for (int tick = 0; tick < 10; ++tick) {
    const Wrench out = limiter.limit(1e-3 * tick, wrench(Vec3(0.5, 0, 1), Vec3(0.1, -2, 1e6)), true);
    EXPECT_EQ(out.moment, Vec3(Vec3::Zero()));
    if (tick > 1) { EXPECT_NEAR(out.force.norm(), std::hypot(0.5, 1.0), 0.01); }
  }
  EXPECT_EQ(limiter.limited_ticks(), 0);
}

TEST(WrenchLimiter, bad_settings_are_refused) {
  EXPECT_NE(message(0.0, 0.2, 0.0, 1e5).find("max_force_n = 0 must be positive"), std::string::npos);
  EXPECT_NE(message(3.3, kNaN, 0.0, 1e5).find("max_torque_n_m = nan must not be negative"),
            std::string::npos);
  EXPECT_NE(message(3.3, 0.2, -1.0, 1e5).find("ramp_s = -1 must not be negative"), std::string::npos);
  EXPECT_NE(message(3.3, 0.2, 0.0, 490.0).find("max_force_slew_n_s = 490 is too small"), std::string::npos);
  EXPECT_EQ(message(3.3, 0.2, 0.0, 496.0), "");
}

TEST(WrenchLimiter, counts_ticks_whose_last_pose_is_older_than_the_fall) {
  WrenchLimiter limiter(3.3, 0.2, 0.0);
  const auto ticks = [&](int first, int count, bool valid) {
    for (int i = first; i < first + count; ++i) limiter.limit(1e-3 * i, {Vec3::Zero(), Vec3(0, 0, 1)}, valid);
  };
  ticks(0, 10, false);
  EXPECT_EQ(limiter.ticks_without_pose(), 10) << "before the first pose";
  ticks(10, 10, true);
  ticks(20, 15, false);
  ticks(35, 5, true);
  EXPECT_EQ(limiter.ticks_without_pose(), 10) << "a gap of 15 ms leaves a force";
  ticks(40, 50, false);
  EXPECT_NEAR(static_cast<double>(limiter.ticks_without_pose()), 10 + 50 - 19, 1) << "no force from 20 ms on";
}
