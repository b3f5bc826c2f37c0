// The simulated hand against theory: closed forms of the mass-spring-damper system, Coulomb's law, and the
// energy that a zero-order hold generates.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "messages.h"
#include "palpate/core/error.h"
#include "palpate/device/device.h"
#include "palpate/device/registry.h"

using namespace palpate;
using namespace palpate::device;
using palpate::expectations::expect_contains;
using palpate::expectations::message_of;

namespace {

constexpr double kTick = 1e-3;

/// A hand with target position `x`, without damping, friction or rounding of positions; 1 kg in total.
DeviceSpec bare(double k = 0.0, double b = 0.0, const Vec3& x = Vec3::Zero()) {
  DeviceSpec spec;
  spec.type = "hand";
  spec.keyframes = {{0.0, x, Vec3::Zero(), Interpolation::kMinimumJerk}};
  spec.arm_mass_kg = 0.9;
  spec.device_mass_kg = 0.1;
  spec.arm_stiffness_n_m = k;
  spec.arm_damping_n_s_m = b;
  spec.max_force_n = 1e6;
  spec.max_torque_n_m = 1e6;
  return spec;
}

Wrench push(double force) { return {Vec3::Zero(), Vec3(force, 0, 0)}; }

/// Returns x and v after `ticks` under a force that is constant from the first tick on.
Eigen::Vector2d pushed(DeviceSpec spec, double force, int ticks) {
  const auto device = make_device(spec);
  device->sample(0.0);
  for (int i = 1; i <= ticks; ++i) {
    device->feedback((i - 1) * kTick, push(force));
    device->sample(i * kTick);
  }
  return {device->position().x(), device->linear_velocity().x()};
}

/// Response of m x'' + b x' + k x = F from rest, m = 1: x = F/k (1 - exp(-z t) (cos w t + z/w sin w t)).
Eigen::Vector2d step_response(double k, double b, double force, double t) {
  const double z = 0.5 * b, w = std::sqrt(k - z * z), decay = std::exp(-z * t);
  return {force / k * (1.0 - decay * (std::cos(w * t) + z / w * std::sin(w * t))),
          force / w * decay * std::sin(w * t)};
}

}  // namespace

TEST(Hand, a_held_force_gives_the_closed_form) {
  for (const auto& [k, b] : {std::pair{568.0, 5.5}, {4e4, 2.0}, {90.0, 0.0}})
    for (const int ticks : {1, 7, 400}) {
      const Eigen::Vector2d x = pushed(bare(k, b), 2.0, ticks),
                            exact = step_response(k, b, 2.0, ticks * kTick);
      EXPECT_NEAR(x[0], exact[0], 1e-12 * 2.0 / k) << k << ", " << ticks;
      EXPECT_NEAR(x[1], exact[1], 1e-12 * 2.0 / std::sqrt(k)) << k << ", " << ticks;
    }
  const Eigen::Vector2d alone = pushed(bare(), 2.0, 50);  // a free mass: F t^2/2
  EXPECT_NEAR(alone[0], 2.0 * 0.05 * 0.05 / 2.0, 1e-15);
  EXPECT_NEAR(alone[1], 2.0 * 0.05, 1e-14);
  const Eigen::Vector2d damped = pushed(bare(0.0, 3.0), 6.0, 100);  // v = F/b (1 - exp(-b t))
  EXPECT_NEAR(damped[1], 2.0 * (1.0 - std::exp(-0.3)), 1e-13);
}

// Pushed for one tick and then released: the rest is the free motion from the state at the end of the push.
TEST(Hand, free_motion_is_the_closed_form) {
  const double k = 568.0, b = 5.5, z = 0.5 * b, w = std::sqrt(k - z * z);
  const Eigen::Vector2d start = step_response(k, b, 100.0, kTick);
  const auto device = make_device(bare(k, b));
  device->sample(0.0);
  device->feedback(0.0, push(100.0));
  device->sample(kTick);
  device->feedback(kTick, {});
  for (int i = 1; i <= 300; ++i) {
    const double t = i * kTick;
    device->sample(kTick + t);
    const double x =
        std::exp(-z * t) * (start[0] * std::cos(w * t) + (start[1] + z * start[0]) / w * std::sin(w * t));
    ASSERT_NEAR(device->position().x(), x, 1e-15) << i;  // amplitude 5e-5 or less
  }
}

TEST(Hand, rests_where_spring_and_force_balance) {
  DeviceSpec spec = bare(568.0, 30.0, Vec3(0.1, 0.2, 0.3));
  const Eigen::Vector2d x = pushed(spec, 3.0, 5000);
  EXPECT_NEAR(x[0], 0.1 + 3.0 / 568.0, 1e-12);
  EXPECT_NEAR(x[1], 0.0, 1e-12);
}

// A path at constant speed pulls the hand with k x_d + b v_d. In the steady state M a = 0: the hand follows
// at the same speed, and lags by c v/k, which comes from the device's damping c alone.
TEST(Hand, lags_a_moving_path_by_the_devices_own_damping) {
  DeviceSpec spec = bare(568.0, 20.0);
  spec.device_damping_n_s_m = 4.0;
  spec.keyframes = {{0.0, Vec3::Zero(), Vec3::Zero(), Interpolation::kLinear},
                    {10.0, Vec3(2, 0, 0), Vec3::Zero(), Interpolation::kLinear}};
  const auto device = make_device(spec);
  for (int i = 0; i <= 6000; ++i) device->sample(i * kTick);
  EXPECT_NEAR(device->position().x(), 0.2 * 6.0 - 4.0 * 0.2 / 568.0, 1e-11);
  EXPECT_NEAR(device->linear_velocity().x(), 0.2, 1e-11);
}

TEST(Hand, turns_as_it_shifts) {
  DeviceSpec spec = bare(568.0, 5.5);
  spec.rotational_inertia_kg_m2 = 1.0;
  spec.arm_rotational_stiffness_n_m_rad = 50.0;
  spec.arm_rotational_damping_n_m_s_rad = 3.0;
  spec.keyframes[0].rotation_vector_rad = Vec3(0, 0.4, 0);
  const auto device = make_device(spec);
  device->sample(0.0);
  device->set_force_and_torque(Vec3::Zero(), Vec3(0, 2.0, 0));
  for (int i = 1; i <= 100; ++i) device->sample(i * kTick);
  const Eigen::Vector2d exact = step_response(50.0, 3.0, 2.0, 0.1);
  EXPECT_NEAR(rotation_vector(device->rotation()).y(), 0.4 + exact[0], 1e-13);
  EXPECT_NEAR(device->angular_velocity().y(), exact[1], 1e-13);
}

TEST(Hand, sticks_below_coulombs_level_and_slides_above) {
  DeviceSpec spec = bare(200.0, 0.0);
  spec.device_friction_n = 0.5;
  EXPECT_EQ(pushed(spec, 0.499, 1000), Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(pushed(spec, -0.499, 1000), Eigen::Vector2d(0.0, 0.0));
  // sliding: from rest m x'' + k x = F - f until x' = 0 at half a period, 2 (F - f)/k away
  const double w = std::sqrt(200.0);
  const Eigen::Vector2d sliding = pushed(spec, 0.7, 100);
  EXPECT_NEAR(sliding[0], 0.2 / 200.0 * (1.0 - std::cos(w * 0.1)), 1e-14);
  EXPECT_NEAR(sliding[1], 0.2 / w * std::sin(w * 0.1), 1e-13);
  // at that point the spring's 0.4 N exceeds the push by less than f: it sticks, at exactly zero velocity
  const Eigen::Vector2d stuck = pushed(spec, 0.7, 1000);
  EXPECT_NEAR(stuck[0], 2.0 * 0.2 / 200.0, 1e-13);
  EXPECT_EQ(stuck[1], 0.0);
}

// Oscillations under Coulomb friction alone lose 2 f/k of amplitude per half period (textbook result).
TEST(Hand, swings_shrink_by_coulombs_decrement) {
  const double k = 400.0, f = 0.3, w = std::sqrt(k);
  DeviceSpec spec = bare(k, 0.0);
  spec.device_friction_n = f;
  spec.keyframes = {{0.0, Vec3::Zero(), Vec3::Zero(), Interpolation::kStep},
                    {1e-9, Vec3(0.02, 0, 0), Vec3::Zero(), Interpolation::kStep}};
  const auto device = make_device(spec);
  device->sample(0.0);
  device->sample(1e-9);
  const double half = std::numbers::pi / w;
  double amplitude = 0.02;
  int turns = 0;
  for (int i = 1; amplitude > 2.0 * f / k; ++i) {
    // a sample time that is unrelated to the period, and one at the end of the half period
    device->sample(1e-9 + (i - 0.37) * half);
    device->sample(1e-9 + i * half);
    amplitude -= 2.0 * f / k;
    const double side = i % 2 ? 1.0 : -1.0;
    EXPECT_NEAR(device->position().x(), 0.02 + side * amplitude, 1e-10) << i;
    ++turns;
  }
  EXPECT_EQ(turns, 13);
}

TEST(Hand, friction_never_makes_energy) {
  for (const double tick : {1e-4, 1e-3, 0.02, 0.11}) {
    DeviceSpec spec = bare(300.0, 0.0);
    spec.device_friction_n = 0.2;
    const auto device = make_device(spec);
    device->sample(0.0);
    device->feedback(0.0, {Vec3::Zero(), Vec3(30.0, -12.0, 3.0)});
    device->sample(tick);
    device->feedback(tick, {});
    const auto energy = [&] {
      return 0.5 * device->linear_velocity().squaredNorm() + 150.0 * device->position().squaredNorm();
    };
    double last = energy(), first = last;
    for (int i = 2; i * tick < 8.0 + 300.0 * tick; ++i) {
      device->sample(i * tick);
      ASSERT_LE(energy(), last * (1.0 + 1e-12)) << tick << ", " << i;
      last = energy();
    }
    EXPECT_LT(last, first);
    EXPECT_EQ(device->linear_velocity(), Vec3(0, 0, 0)) << "at rest in the end, tick " << tick;
  }
}

TEST(Hand, what_is_read_is_off_by_at_most_half_a_step) {
  DeviceSpec fine = bare(568.0, 1.0), coarse = fine;
  coarse.encoder_resolution_m = 3e-5;
  coarse.encoder_resolution_rad = 1e-3;
  const auto exact = make_device(fine), read = make_device(coarse);
  exact->sample(0.0), read->sample(0.0);
  double largest = 0.0;
  for (int i = 1; i <= 500; ++i) {
    for (const auto* one : {&exact, &read}) {
      (*one)->feedback((i - 1) * kTick, {Vec3(0, 0, 0.01), Vec3(1.0, 0.3, 0)});
      (*one)->sample(i * kTick);
    }
    const Vec3 off = read->position() - exact->position();
    largest = std::max(largest, off.cwiseAbs().maxCoeff());
    EXPECT_LE(rotation_vector(read->rotation() * exact->rotation().conjugate()).norm(), 0.5e-3 + 1e-12);
    const double steps = read->position().x() / 3e-5;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
  }
  EXPECT_LE(largest, 1.5e-5 * (1.0 + 1e-9));
  EXPECT_GT(largest, 1.2e-5) << "it was rounded";
}

// The filter's response to a ramp of slope v is v (1 - exp(-2 pi f_c t)).
TEST(Hand, velocity_comes_from_positions_through_a_low_pass) {
  DeviceSpec spec = bare();
  spec.velocity_cutoff_per_s = 30.0;
  const auto device = make_device(spec);
  device->sample(0.0);
  device->feedback(0.0, push(1000.0));
  device->sample(kTick);
  device->feedback(kTick, {});
  double before = device->linear_velocity().x();
  for (int i = 2; i < 60; ++i) {
    device->sample(i * kTick);
    const double v = device->linear_velocity().x();
    EXPECT_NEAR((1.0 - v) / (1.0 - before), std::exp(-2.0 * std::numbers::pi * 30.0 * kTick), 1e-9);
    before = v;
  }
  EXPECT_GT(before, 0.999);
}

TEST(Hand, the_motors_saturate_and_have_steps) {
  DeviceSpec spec = bare(100.0, 20.0);
  spec.max_force_n = 3.0;
  EXPECT_NEAR(pushed(spec, 50.0, 4000)[0], 0.03, 1e-12);
  spec.force_resolution_n = 0.25;
  EXPECT_NEAR(pushed(spec, 1.1, 4000)[0], 0.01, 1e-12);
  EXPECT_NEAR(pushed(spec, 1.13, 4000)[0], 0.0125, 1e-12);
}

TEST(Hand, a_force_arrives_after_its_delay) {
  for (const double delay : {0.0, 3 * kTick, 2.4 * kTick}) {
    DeviceSpec spec = bare();
    spec.delay_s = delay;
    const auto device = make_device(spec);
    device->sample(0.0);
    for (int i = 0; i < 10; ++i) {  // sent at each tick from 0 on, held for one tick each
      device->feedback(i * kTick, push(i == 0 ? 1000.0 : 0.0));
      device->sample((i + 1) * kTick);
      const double t = (i + 1) * kTick, on = std::clamp(t - delay, 0.0, kTick);
      EXPECT_NEAR(device->linear_velocity().x(), 1000.0 * on, 1e-9) << delay << ", " << i;
    }
  }
}

// A wall F = -K x, sampled and held for T, on a free mass with damping c. A hold lags by T/2, so it adds K
// T/2 v^2 to the motion while damping removes c v^2 (Colgate and Schenkel 1994, Gil et al. 2004): the
// oscillation grows where K T/2 > c. Here the wall has no damping, and the mass is so large that K T^2/M is
// small.
TEST(Hand, a_held_wall_gains_energy_where_colgate_says) {
  const double K = 2000.0;
  const auto growth = [&](double damping) {
    DeviceSpec spec = bare();
    spec.device_damping_n_s_m = damping;
    const auto device = make_device(spec);
    device->sample(0.0);
    double early = 0.0, late = 0.0;
    for (int i = 0; i < 4000; ++i) {
      const double x = device->position().x();
      device->feedback(i * kTick, push(i == 0 ? 100.0 : -K * x));
      device->sample((i + 1) * kTick);
      const double energy = 0.5 * K * x * x + 0.5 * std::pow(device->linear_velocity().x(), 2);
      if (i > 100 && i < 400) early = std::max(early, energy);
      if (i >= 3700) late = std::max(late, energy);
    }
    return late / early;
  };
  const double critical = K * kTick / 2.0;  // 1 N s/m
  EXPECT_GT(growth(0.0), 20.0);
  EXPECT_GT(growth(0.95 * critical), 1.05);
  EXPECT_LT(growth(1.05 * critical), 0.95);
  EXPECT_LT(growth(2.0 * critical), 0.1);
}

TEST(Hand, answers_a_time_twice_with_the_same_sample) {
  const auto a = make_device(bare(568.0, 5.5)), b = make_device(bare(568.0, 5.5));
  for (int i = 0; i < 50; ++i) {
    a->sample(i * kTick);
    for (int again = 0; again < 3; ++again) b->sample(i * kTick);
    EXPECT_EQ(a->position(), b->position());
    a->feedback(i * kTick, push(1.0)), b->feedback(i * kTick, push(1.0));
  }
  EXPECT_GT(a->position().x(), 0.0);
  EXPECT_FALSE(a->path()) << "a hand that yields has no path beforehand";
}

TEST(Hand, bad_settings_are_refused) {
  int checked = 0;
  const auto refused = [&](auto set, const std::string& part) {
    DeviceSpec spec = bare();
    set(spec);
    expect_contains(message_of([&] { make_device(spec); }), part);
    ++checked;
  };
  refused([](DeviceSpec& s) { s.arm_mass_kg = -1.0; }, "device: arm_mass_kg = -1 must not be negative");
  refused([](DeviceSpec& s) { s.arm_damping_n_s_m = NAN; }, "arm_damping_n_s_m = nan");
  refused([](DeviceSpec& s) { s.arm_stiffness_n_m = -2.0; }, "arm_stiffness_n_m = -2");
  refused([](DeviceSpec& s) { s.device_mass_kg = 0.0; }, "device_mass_kg = 0 must be positive");
  refused([](DeviceSpec& s) { s.device_damping_n_s_m = -1.0; }, "device_damping_n_s_m = -1");
  refused([](DeviceSpec& s) { s.device_friction_n = -1.0; }, "device_friction_n = -1");
  refused([](DeviceSpec& s) { s.rotational_inertia_kg_m2 = 0.0; }, "rotational_inertia_kg_m2 = 0");
  refused([](DeviceSpec& s) { s.arm_rotational_damping_n_m_s_rad = -1.0; },
          "arm_rotational_damping_n_m_s_rad");
  refused([](DeviceSpec& s) { s.arm_rotational_stiffness_n_m_rad = -1.0; },
          "arm_rotational_stiffness_n_m_rad");
  refused([](DeviceSpec& s) { s.rotational_friction_n_m = -1.0; }, "rotational_friction_n_m = -1");
  refused([](DeviceSpec& s) { s.encoder_resolution_m = -1.0; }, "encoder_resolution_m = -1");
  refused([](DeviceSpec& s) { s.encoder_resolution_rad = -1.0; }, "encoder_resolution_rad = -1");
  refused([](DeviceSpec& s) { s.velocity_cutoff_per_s = -1.0; }, "velocity_cutoff_per_s = -1");
  refused([](DeviceSpec& s) { s.force_resolution_n = -1.0; }, "force_resolution_n = -1");
  refused([](DeviceSpec& s) { s.delay_s = 2.0; }, "delay_s = 2 must lie in [0, 1]");
  refused([](DeviceSpec& s) { s.keyframes.clear(); }, "no keyframes");
  EXPECT_EQ(checked, 16);
}
