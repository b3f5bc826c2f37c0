#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "messages.h"
#include "palpate/core/error.h"
#include "palpate/device/device.h"
#include "palpate/device/keyframes.h"
#include "palpate/device/motions.h"
#include "palpate/device/registry.h"

using namespace palpate;
using namespace palpate::device;
using palpate::expectations::expect_contains;
using palpate::expectations::message_of;

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

MotionSpec motion(const std::string& kind) {
  MotionSpec m;
  m.kind = kind;
  m.amplitude_m = Vec3(0.01, -0.02, 0.005);
  m.second_amplitude_m = Vec3(0.0, 0.01, 0.03);
  m.frequency_per_s = 3.0;
  m.end_frequency_per_s = 9.0;
  m.start_s = 0.5;
  m.duration_s = 2.0;
  return m;
}

double error(const MotionSpec& m, double t, double h) {
  const Displacement a = displacement(m, t - h), o = displacement(m, t), b = displacement(m, t + h);
  return ((b.x - a.x) / (2 * h) - o.v).norm() + ((b.v - a.v) / (2 * h) - o.a).norm();
}

}  // namespace

TEST(Motions, velocity_and_acceleration_are_the_derivatives) {
  int checked = 0;
  for (const auto& entry : motion_registry())
    for (const double t : {0.61, 0.97, 1.4, 2.33}) {
      std::vector<double> e;
      for (double h = 4e-3; h > 2e-4; h /= 2) e.push_back(error(motion(entry.name), t, h));
      for (std::size_t i = 1; i < e.size(); ++i) EXPECT_NEAR(std::log2(e[i - 1] / e[i]), 2.0, 0.1) << t;
      ++checked;
    }
  EXPECT_EQ(checked, 16);
}

TEST(Motions, are_what_their_formulas_say) {
  const Vec3 A = motion("tap").amplitude_m, B = motion("tap").second_amplitude_m;
  const double quarter = 0.5 + 0.25 / 3.0, half = 0.5 + 0.5 / 3.0;
  EXPECT_LT((displacement(motion("stroke"), quarter).x - A).norm(), 1e-16);
  EXPECT_LT(displacement(motion("stroke"), half).x.norm(), 1e-16);
  EXPECT_LT((displacement(motion("tap"), half).x - A).norm(), 1e-16);
  EXPECT_LT(displacement(motion("tap"), 0.5).v.norm(), 1e-16) << "begins at rest";
  EXPECT_LT((displacement(motion("circle"), quarter).x - (B - A)).norm(), 1e-16);
  EXPECT_LT((displacement(motion("circle"), half).x + 2.0 * A).norm(), 1e-16);
  // chirp: (f0 + f1)/2 D = 12 periods in all, and f0 D/2 + (f1 - f0) D/8 = 4.5 periods at its middle
  EXPECT_LT(displacement(motion("chirp"), 2.5).x.norm(), 1e-15);
  EXPECT_LT((displacement(motion("chirp"), 1.5).v + A * kTurn * 6.0).norm(), 1e-12);
}

TEST(Motions, begin_and_end) {
  for (const auto& entry : motion_registry()) {
    const MotionSpec m = motion(entry.name);
    EXPECT_EQ(displacement(m, 0.4999).x, Vec3(0, 0, 0)) << entry.name;
    EXPECT_LT(displacement(m, 0.5).x.norm(), 1e-16) << entry.name;
    EXPECT_LT((displacement(m, 2.5).x - displacement(m, 2.5 - 1e-9).x).norm(), 1e-8) << entry.name;
    EXPECT_EQ(displacement(m, 3.0).v, Vec3(0, 0, 0)) << entry.name;
    EXPECT_EQ(displacement(m, 3.0).x, displacement(m, 2.5).x) << entry.name;
  }
}

TEST(Motions, add_to_the_keyframes) {
  DeviceSpec spec;
  spec.keyframes = {{0.0, Vec3(1, 2, 3), Vec3(0.1, 0, 0), Interpolation::kLinear},
                    {4.0, Vec3(2, 2, 3), Vec3::Zero(), Interpolation::kLinear}};
  spec.motions = {motion("stroke"), motion("tap")};
  const auto device = make_device(spec);
  for (const double t : {0.2, 0.8, 3.1}) {
    const HandleSample s = device->sample(t), keys = sample_keyframes(spec.keyframes, t);
    const Displacement a = displacement(spec.motions[0], t), b = displacement(spec.motions[1], t);
    EXPECT_LT((s.pose.translation - keys.pose.translation - a.x - b.x).norm(), 1e-15);
    EXPECT_LT((s.twist.linear - keys.twist.linear - a.v - b.v).norm(), 1e-15);
    EXPECT_LT((s.acceleration.linear - a.a - b.a).norm(), 1e-14);
    EXPECT_EQ(s.twist.angular, keys.twist.angular);
    EXPECT_EQ(device->path()(t).pose.translation, s.pose.translation);
  }
}

TEST(Motions, bad_ones_are_refused) {
  const auto refused = [](auto set, const std::string& part) {
    DeviceSpec spec;
    spec.keyframes = {KeyframeSpec{}};
    spec.motions = {motion("stroke"), motion("chirp")};
    set(spec.motions[1]);
    expect_contains(message_of([&] { make_device(spec); }), "device: motion[1]" + part);
  };
  refused([](MotionSpec& m) { m.frequency_per_s = 0.0; }, ": frequency_per_s = 0 must be positive");
  refused([](MotionSpec& m) { m.end_frequency_per_s = -1.0; }, ": end_frequency_per_s = -1");
  refused([](MotionSpec& m) { m.start_s = -1.0; }, ": start_s = -1 must not be negative");
  refused([](MotionSpec& m) { m.duration_s = -1.0; }, ": duration_s = -1");
  refused([](MotionSpec& m) { m.duration_s = 0.0; },
          ": duration_s = 0 must be positive; it is the duration of the sweep");
  refused([](MotionSpec& m) { m.amplitude_m.x() = NAN; }, ": amplitudes must be finite");
  DeviceSpec spec;
  spec.keyframes = {KeyframeSpec{}};
  spec.motions = {motion("strok")};
  expect_contains(message_of([&] { make_device(spec); }), "device: motion[0]: kind \"strok\" (did you mean");
}

// Presses are kept for their time by the script and by the simulated hand: fingers do not yield to the force.
TEST(Presses, hold_their_switches_for_their_time) {
  for (const char* type : {"script", "hand"}) {
    DeviceSpec spec;
    spec.type = type;
    spec.keyframes = {{}};
    spec.presses = {{0, 0.2, 0.3}, {3, 0.4, 0.0}};
    const auto device = make_device(spec);
    EXPECT_EQ(device->sample(0.1).switches, 0u) << type;
    EXPECT_EQ(device->sample(0.2).switches, 1u) << type;
    EXPECT_EQ(device->sample(0.45).switches, 9u) << type;
    EXPECT_EQ(device->sample(0.5).switches, 8u) << type;
    EXPECT_EQ(device->sample(100.0).switches, 8u) << type << ": to the end";
    spec.presses = {{32, 0.0, 0.0}};
    expect_contains(message_of([&] { make_device(spec); }), "device: press[0]: switch = 32");
    spec.presses = {{0, -1.0, 0.0}};
    expect_contains(message_of([&] { make_device(spec); }), "device: press[0]: start_s = -1");
  }
}
