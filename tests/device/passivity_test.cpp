#include "palpate/device/passivity.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "device/buzz.h"
#include "palpate/core/error.h"

using namespace palpate;
using namespace palpate::device;
using Mode = PassivityController::Mode;

namespace {

constexpr double T = 1e-3;

Pose at(double x) { return {Quat::Identity(), Vec3(x, 0, 0)}; }
Wrench force(double f) { return {Vec3::Zero(), Vec3(f, 0, 0)}; }

/// A mass with viscous damping b under the force of the motors (zero-order hold, delayed by ticks, quantised
/// and saturated) and of a hand, on the virtual wall F = -K x - B (x_k - x_{k-1})/T in x > 0.
struct Loop {
  double K, B, b, mass = 0.045;
  Motors motors;
  PassivityController controller;
  double x = 0.0, v = 0.0, last = 0.0, F = 0.0, time = 0.0, largest = 0.0;
  std::vector<double> sent;
  double energy = 0.0, least = 0.0;  ///< energy at the port, summed independently of the controller

  Loop(double k, double damping, double own, Mode mode, const Motors::Figures& figures = {})
      : K(k),
        B(damping),
        b(own),
        motors(figures),
        controller(mode, {.damping = own, .delay = figures.delay, .tick = T}) {}
  void tick(double hand) {
    const double requested = x > 0.0 ? -K * x - B * (x - last) / T : 0.0, D = x - last;
    motors.advance(time);
    if (!sent.empty()) {
      energy += -F * D + b * D * D / T;
      least = std::min(least, energy);
    }
    sent.push_back(controller.apply(time, at(x), motors, force(requested)).force.x());
    motors.send(time, force(sent.back()));
    const std::size_t delay = static_cast<std::size_t>(std::lround(motors.delay() / T));
    F = sent.size() > delay ? motors.shaped(force(sent[sent.size() - 1 - delay])).force.x() : 0.0;
    last = x;
    const double a = std::exp(-b * T / mass), p = F + hand;  // exact
    x += mass / b * (1.0 - a) * (v - p / b) + p / b * T;
    v = a * v + (1.0 - a) * p / b;
    time += T;
    largest = std::max(largest, std::abs(x));
  }
};

}  // namespace

TEST(Passivity, observer_of_a_passive_wall_never_falls_below_zero) {
  std::mt19937 random(3);
  std::normal_distribution<double> push;
  int pressed = 0;
  for (int run = 0; run < 40; ++run) {
    const double b = 0.5 + 0.1 * run, K = 0.6 * 2.0 * b / T, B = (run % 2 ? 0.39 : -0.39) * b;
    Loop loop(K, B, b, Mode::kControl);
    double hand = 0.0;
    for (int i = 0; i < 4000; ++i) {
      hand = 0.99 * hand + 0.2 * push(random);
      loop.tick(hand + 0.3);
      pressed += loop.F < 0.0;
    }
    EXPECT_GE(loop.controller.observer().least_energy(), -1e-12) << run;
    EXPECT_EQ(loop.controller.dissipated(), 0.0) << run;
    EXPECT_EQ(loop.controller.active_ticks(), 0) << run;
  }
  EXPECT_GT(pressed, 10000);
}

// The energy per cycle of the triangle wave of period 2T is (8 A^2/T)(b - K T/2 - B). With one tick of delay
// this wave is no worst case; a slow one is, with b = 3 K T/2 at frequency 0.
TEST(Passivity, triangle_wave_attains_the_bound_of_theory) {
  const double A = 1e-3, centre = 2e-3, b = 1.0, K = 1500.0, B = 0.4;
  PassivityObserver observer(b);
  double last = centre - A, before = 0.0;
  int cycles = 0;
  for (int i = 0; i < 40; ++i) {
    const double x = centre + (i % 2 ? A : -A);
    observer.sample(i * T, at(x));
    if (i >= 4 && i % 2 == 0) {
      EXPECT_NEAR(observer.energy() - before, 8.0 * A * A / T * (b - 0.5 * K * T - B), 1e-12);
      ++cycles;
    }
    if (i % 2 == 0) before = observer.energy();
    observer.hold(force(-K * x - B * (x - last) / T));
    last = x;
  }
  EXPECT_EQ(cycles, 18);
  EXPECT_LT(observer.least_energy(), 0.0);
}

// A sine with one tick of delay: per cycle the energy is sum D^2 (b/T - K/2 s), with s = sin(3 w T/2)/sin(w
// T/2) -> 3.
TEST(Passivity, a_tick_of_delay_needs_three_times_the_damping) {
  const double K = 1000.0, A = 1e-3;
  const int period = 200;
  const double w = 2.0 * std::numbers::pi / period;
  const double needed = 0.5 * K * T * std::sin(1.5 * w) / std::sin(0.5 * w);
  EXPECT_NEAR(needed, 1.5 * K * T, 2e-3);
  for (const double factor : {0.999, 1.001}) {
    PassivityObserver observer(factor * needed);
    double held = 0.0, before = 0.0;
    for (int i = 0; i <= 2 * period; ++i) {
      const double x = A * std::sin(w * i);
      observer.sample(i * T, at(x));
      if (i == period) before = observer.energy();
      observer.hold(force(held));
      held = -K * x;
    }
    EXPECT_EQ(observer.energy() > before, factor > 1.0) << factor;
  }
}

// A slow handle that is read in steps of 30 um rests for 29 ticks and then jumps: b D^2/T of the jump is 30
// times the dissipated energy. The observer must not count more than was dissipated.
TEST(Passivity, friction_of_positions_in_steps_is_never_counted_for_more_than_it_is) {
  constexpr double b = 2.0, step = 30e-6;
  const auto counted = [&](double speed, double resolution) {
    PassivityObserver observer(b, resolution);
    for (int k = 0; k <= 1000; ++k) {
      observer.sample(k * T, at(step * std::round(k * T * speed / step)));
      observer.hold(force(0.0));
    }
    return observer.energy() / (b * speed * speed);  // relative to the exact energy dissipated in one second
  };
  EXPECT_NEAR(counted(1e-3, 0.0), 30.0, 1.0) << "the fault to be kept out";
  EXPECT_LE(counted(1e-3, step), 1.0);
  EXPECT_LE(counted(0.5, step), 1.0);
  EXPECT_GE(counted(0.5, step), 0.85);
}

TEST(Passivity, a_scene_s_device_has_its_friction_counted) {
  DeviceSpec spec;
  spec.type = "hand";
  spec.device_damping_n_s_m = 2.0;
  EXPECT_EQ(make_passivity_controller(Mode::kOff, spec, T), nullptr);
  const auto exact = make_passivity_controller(Mode::kObserve, spec, T);
  spec.encoder_resolution_m = 1e-3;
  const auto in_steps = make_passivity_controller(Mode::kObserve, spec, T);
  for (auto* controller : {exact.get(), in_steps.get()})
    for (const double k : {0.0, 1.0, 2.0}) controller->apply(k * T, at(k * 5e-3), Motors(), {});
  EXPECT_NEAR(exact->observer().energy(), 2.0 * 2.0 * 25e-6 / T, 1e-12);
  EXPECT_NEAR(in_steps->observer().energy(), 2.0 * 2.0 * 16e-6 / T, 1e-12);
}

TEST(Passivity, controller_keeps_an_active_wall_above_zero) {
  for (const Mode mode : {Mode::kObserve, Mode::kControl}) {
    Loop loop(2000.0, 0.0, 0.1, mode);  // ten times the passivity limit, and the stability limit
    for (int i = 0; i < 4000; ++i) loop.tick(0.5);
    const PassivityObserver& observer = loop.controller.observer();
    if (mode == Mode::kObserve) {
      EXPECT_LT(observer.least_energy(), -1e-3);
      EXPECT_EQ(loop.controller.dissipated(), 0.0);
    } else {
      EXPECT_GE(observer.least_energy(), -1e-6);
      EXPECT_GT(loop.controller.dissipated(), 1e-6);
      EXPECT_LT(loop.controller.dissipated(), observer.work());
      EXPECT_LT(loop.largest, 2e-3);
    }
  }
}

// The force is reduced by the motions that the handle may make. If it then turns back, the removed part would
// have resisted it: the reduction spares the hand that work, which counts negative.
TEST(Passivity, kept_energy_is_negative_where_the_removed_force_would_have_resisted) {
  for (const double step : {1e-3, -1e-3}) {  // the motion in the tick of the reduced force
    PassivityController controller(Mode::kControl, {.tick = T});
    Motors motors;
    const auto tick = [&](double t, double x, double requested) {
      motors.advance(t);
      const Wrench out = controller.apply(t, at(x), motors, force(requested));
      motors.send(t, out);
      return out.force.x();
    };
    tick(0.0, 0.0, 0.0);
    const double removed = 1.5 - tick(T, 1e-3, 1.5);
    ASSERT_GT(removed, 0.1);
    tick(2 * T, 1e-3 + step, 0.0);
    EXPECT_NEAR(controller.dissipated(), removed * step, 1e-12);
  }
}

// The observed energy is the work of the force that the motors hold: here summed from the forces sent, each
// delayed by whole ticks, quantised and saturated.
TEST(Passivity, observer_counts_the_force_that_the_motors_hold) {
  int negative = 0;
  for (int delay = 0; delay <= 10; ++delay)
    for (const double step : {0.0, 0.05})
      for (const double most : {1e3, 0.8}) {
        Loop loop(600.0, 0.0, 0.6, Mode::kObserve,
                  {.delay = delay * T, .force_step = step, .max_force = most});
        for (int i = 0; i < 2000; ++i) loop.tick(0.6 + std::sin(0.05 * i));
        const PassivityObserver& observer = loop.controller.observer();
        EXPECT_NEAR(observer.energy(), loop.energy, 1e-12 * observer.work()) << delay << ' ' << step;
        EXPECT_NEAR(observer.least_energy(), loop.least, 1e-12 * observer.work()) << delay << ' ' << step;
        negative += loop.least < -1e-5;
      }
  EXPECT_GT(negative, 10) << "delayed walls give energy";
}

// A delay of n + s ticks holds two forces within one tick; at constant speed their mean is exact.
TEST(Passivity, observer_counts_forces_that_change_within_a_tick) {
  constexpr double speed = 0.05, share = 0.3;
  Motors motors({.delay = (2.0 + share) * T});
  PassivityController controller(Mode::kObserve, {.delay = motors.delay(), .tick = T});
  std::vector<double> sent;
  for (int k = 0; k < 50; ++k) {
    motors.advance(k * T);
    sent.push_back(std::cos(0.7 * k));
    controller.apply(k * T, at(k * speed * T), motors, force(sent.back()));
    motors.send(k * T, force(sent.back()));
  }
  double exact = 0.0;  // -sum of each force times the distance over which it is held, up to the last sample
  const double end = 49 * T;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const double from = static_cast<double>(i) * T + motors.delay(), to = std::min(from + T, end);
    if (to > from) exact -= sent[i] * speed * (to - from);
  }
  EXPECT_NEAR(controller.observer().energy(), exact, 1e-15);
}

// Walls far beyond passivity, under delays of up to ten ticks, pressed, stroked and shaken: the energy summed
// here stays above zero, except for the amount that a shake beyond the assumed bounds takes.
TEST(Passivity, controller_guarantees_the_energy_whatever_the_delay) {
  std::mt19937 random(7);
  std::normal_distribution<double> push;
  for (const int delay : {0, 1, 2, 5, 10})
    for (const double K : {600.0, 2000.0})
      for (const double own : {0.1, 0.6})
        for (const char hand : {'p', 's', 'r'}) {
          Loop free(K, 0.0, own, Mode::kObserve, {.delay = delay * T}),
              loop(K, 0.0, own, Mode::kControl, {.delay = delay * T});
          double shake = 0.0;
          for (int i = 0; i < 3000; ++i) {
            shake = 0.97 * shake + 0.2 * push(random);
            const double hand_n = hand == 'p' ? 0.5 : hand == 's' ? 0.4 + std::sin(0.05 * i) : 0.4 + shake;
            free.tick(hand_n);
            loop.tick(hand_n);
          }
          const PassivityObserver& observer = loop.controller.observer();
          const std::string what = fmt::format("delay {}, K {}, b {}, hand {}", delay, K, own, hand);
          EXPECT_NEAR(observer.least_energy(), loop.least, 1e-12 * observer.work()) << what;
          EXPECT_GE(loop.least, hand == 'r' ? -1e-3 : -1e-6) << what << ", free " << free.least;
          if (free.least < -0.1) { EXPECT_GT(loop.least, 0.01 * free.least) << what; }
        }
}

TEST(Passivity, reduced_wrenches_are_shares_of_the_wanted_ones) {
  PassivityController controller(Mode::kControl, {.tick = T});
  Motors motors;
  int reduced = 0;
  for (int i = 0; i < 20; ++i) {
    const Wrench requested{Vec3(0, 0.1, 0), Vec3(i % 2 ? 1.5 : -1.5, 0.3, 0)};
    motors.advance(i * T);
    const Wrench out = controller.apply(i * T, at(i % 2 ? 1e-3 : -1e-3), motors, requested);
    motors.send(i * T, out);
    const double share = out.force.y() / 0.3;
    EXPECT_GE(share, 0.0);
    EXPECT_LE(share, 1.0);
    EXPECT_LT((out.force - share * requested.force).norm(), 1e-15);
    EXPECT_LT((out.moment - share * requested.moment).norm(), 1e-15);
    reduced += share < 1.0;
  }
  EXPECT_GT(reduced, 5);
  EXPECT_EQ(controller.active_ticks(), reduced);
  EXPECT_EQ(PassivityController::mode_of("observe"), Mode::kObserve);
  EXPECT_THROW(PassivityController::mode_of("contrl"), Error);
}

TEST(VibrationMeter, a_tone_passes_above_30_hz_and_not_below) {
  for (const double f : {5.0, 10.0, 30.0, 60.0, 100.0, 400.0}) {
    VibrationMeter buzz(T);
    const int count = 20000;  // whole periods
    for (int i = 0; i < count; ++i) {
      const double x = 2.0 * std::sin(2.0 * std::numbers::pi * f * i * T);
      buzz.add(Vec3(0.6 * x, 0.8 * x, 0.0));
    }
    const double ratio = std::tan(std::numbers::pi * 30.0 * T) / std::tan(std::numbers::pi * f * T);
    const double exact = 2.0 / std::sqrt(2.0) / std::sqrt(1.0 + std::pow(ratio, 8));
    EXPECT_NEAR(buzz.rms(), exact, 0.01 * exact + 2e-3) << f;
  }
  VibrationMeter constant(T);
  for (int i = 0; i < 100; ++i) constant.add(Vec3(1, 2, 3));
  EXPECT_EQ(constant.rms(), 0.0);
  EXPECT_EQ(VibrationMeter(T).rms(), 0.0);
}
