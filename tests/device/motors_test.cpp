// Wrenches held by a device's motors, from the wrenches that were sent.
#include "palpate/device/motors.h"

#include <gtest/gtest.h>

#include "messages.h"
#include "palpate/core/error.h"

using namespace palpate;
using namespace palpate::device;
using palpate::expectations::expect_contains;
using palpate::expectations::message_of;

namespace {

constexpr double T = 1e-3;

Wrench push(double force, double moment = 0.0) { return {Vec3(0, moment, 0), Vec3(force, 0, 0)}; }

}  // namespace

TEST(Motors, hold_each_wrench_from_its_delay_on) {
  for (int delay = 0; delay <= 10; ++delay) {
    Motors motors({.delay = delay * T});
    for (int k = 0; k <= 40; ++k) {
      motors.advance(k * T);
      // over the tick to k, the wrench sent `delay` ticks before its start is held
      EXPECT_NEAR(motors.mean().force.x(), k > delay ? k - delay : 0.0, 1e-13) << delay << ' ' << k;
      motors.send(k * T, push(k + 1.0));
    }
  }
}

TEST(Motors, change_within_a_tick_where_the_delay_ends_there) {
  Motors motors({.delay = 1.25 * T});
  for (int k = 0; k < 5; ++k) {
    motors.advance(k * T);
    motors.send(k * T, push(k + 1.0, 0.1));
  }
  int spans = 0;
  motors.advance(5 * T, [&](const Motors::Span& span) {
    EXPECT_NEAR(span.to - span.from, spans == 0 ? 0.25 * T : 0.75 * T, 1e-15);
    EXPECT_EQ(span.wrench.force.x(), spans == 0 ? 3.0 : 4.0);
    ++spans;
  });
  EXPECT_EQ(spans, 2);
  EXPECT_NEAR(motors.mean().force.x(), 3.75, 1e-12);
  EXPECT_NEAR(motors.mean().moment.y(), 0.1, 1e-12);
  // from here on: 4 for a quarter of a tick, then 5, the last wrench sent, for the rest of 1.25 ticks
  spans = 0;
  motors.coming([&](const Motors::Span& span) {
    EXPECT_NEAR(span.to - span.from, spans == 0 ? 0.25 * T : T, 1e-15);
    EXPECT_EQ(span.wrench.force.x(), spans == 0 ? 4.0 : 5.0);
    ++spans;
  });
  EXPECT_EQ(spans, 2);
}

TEST(Motors, round_and_cut) {
  const Motors motors({.force_step = 0.25, .max_force = 1.1, .max_torque = 0.2});
  EXPECT_EQ(motors.shaped(push(0.6)).force.x(), 0.5);
  EXPECT_NEAR(motors.shaped(push(1.3)).force.x(), 1.1, 1e-15) << "cut behind the rounding";
  EXPECT_NEAR(motors.shaped(push(0.0, -0.5)).moment.y(), -0.2, 1e-15);
}

TEST(Motors, have_the_figures_of_the_scene) {
  DeviceSpec spec;
  spec.delay_s = 3e-3;
  spec.force_resolution_n = 0.01;
  spec.max_force_n = 2.5;
  const Motors::Figures figures = motor_figures(spec);
  EXPECT_EQ(figures.delay, 3e-3);
  EXPECT_EQ(figures.force_step, 0.01);
  EXPECT_EQ(figures.max_force, 2.5);
  spec.delay_s = 2.0;
  expect_contains(message_of([&] { motor_figures(spec); }), "delay_s = 2 must lie in [0, 1]");
}
