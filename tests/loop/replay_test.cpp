// Replay of recordings: forces are bitwise equal from the recorded exchange, and equal to the integrator's
// error when the bodies are simulated again.
#include "loop/replay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "loop/haptic_record.h"
#include "palpate/core/error.h"
#include "palpate/device/keyframes.h"
#include "palpate/loop/run.h"
#include "small_scenes.h"

namespace {

using namespace palpate;

scene::Description pressed() {
  scene::Description d = small_scenes::pressed_block(0.0);
  d.duration_s = 0.2;
  KeyframeSpec down = d.device->keyframes.front();
  down.time_s = 0.15;
  down.position_m.z() -= 0.008;
  down.rotation_vector_rad = Vec3(0.1, 0.3, -0.2);
  d.device->keyframes.push_back(down);
  return d;
}

using Passivity = device::PassivityController::Mode;

loop::HapticRecord recorded(const scene::Description& d, bool real_time, const char* name,
                            std::unique_ptr<device::Device> hand = {},
                            Passivity passivity = Passivity::kOff) {
  const std::string path = (std::filesystem::path(::testing::TempDir()) / name).string();
  const auto world = loop::assemble(d, std::move(hand));
  {
    loop::HapticRecorder recorder(path);
    loop::RunOptions options;
    options.real_time = real_time;
    options.passivity = passivity;
    options.observers = {&recorder};
    EXPECT_TRUE(loop::run(*world, options).status.ok());
  }
  return loop::read_haptic_record(path);
}

/// Checks that forces on the hand and tool poses are bitwise equal.
void expect_equal(const std::vector<loop::TickRecord>& a, const std::vector<loop::TickRecord>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].time, b[i].time);
    ASSERT_EQ(a[i].device.force, b[i].device.force) << i;
    ASSERT_EQ(a[i].device.moment, b[i].device.moment) << i;
    ASSERT_EQ(a[i].contact.force, b[i].contact.force) << i;
    ASSERT_EQ(a[i].tool.translation, b[i].tool.translation) << i;
    ASSERT_EQ(a[i].tool.rotation.coeffs(), b[i].tool.rotation.coeffs()) << i;
    ASSERT_EQ(a[i].record_version, b[i].record_version) << i;
  }
}

double peak(const std::vector<loop::TickRecord>& ticks) {
  double out = 0.0;
  for (const loop::TickRecord& tick : ticks) out = std::max(out, tick.device.force.norm());
  return out;
}

// Real time: the record that a tick used is accidental; its forces follow from that record alone.
TEST(Replay, RetracesARunInRealTimeBitForBit) {
  const scene::Description d = pressed();
  const loop::HapticRecord record = recorded(d, true, "real.h5");
  ASSERT_EQ(record.ticks.size(), 200u);
  EXPECT_GT(peak(record.ticks), 0.1);
  EXPECT_GE(record.exchanges.size(), record.ticks.back().record_version);
  expect_equal(loop::retrace(d, {record}), record.ticks);
}

// Contact with an obstacle is not recorded: it is computed within the ticks, and follows from them.
TEST(Replay, RetracesAToolOnAnObstacle) {
  for (const bool real_time : {false, true}) {
    scene::Description d = pressed();
    small_scenes::add_floor(d, d.contacts.front());
    d.contacts.back().first = "tool";
    d.contacts.back().friction = 0.3;
    // floor 1 mm below the block's top: the tool presses on both
    d.obstacles.back().shape = {{"position_m", Vec3(0, 0, 0.019)}};
    const loop::HapticRecord record = recorded(d, real_time, "floored.h5");
    expect_equal(loop::retrace(d, {record}), record.ticks);
    scene::Description softer = d;
    softer.contacts.back().stiffness_pa_m *= 0.5;
    const auto changed = loop::retrace(softer, {record});
    EXPECT_NE(changed.back().device.force, record.ticks.back().device.force) << "it had no part in it";
  }
}

TEST(Replay, RetracesVirtualTimeWithLatency) {
  scene::Description d = pressed();
  d.exchange.latency_ticks = 25;  // longer than two exchange periods
  const int period = static_cast<int>(std::lround(d.exchange.exchange_period_s / d.tool->tick_s));
  ASSERT_EQ(period, 10);
  loop::HapticRecord record = recorded(d, false, "later.h5");
  expect_equal(loop::retrace(d, {record}), record.ticks);
  for (std::size_t i = 0; i < record.ticks.size(); ++i) {
    const int exchanges = std::max(0, (static_cast<int>(i) - 25) / period);  // adopted since the first
    EXPECT_EQ(record.ticks[i].record_version, i < 25 ? 1 : 1 + exchanges) << i;
  }
  d.exchange.latency_ticks = 4;
  record = recorded(d, false, "late.h5");
  expect_equal(loop::retrace(d, {record}), record.ticks);
  // another exchange gives another force
  loop::HapticRecord other = record;
  for (auto& model : other.models)
    for (auto& point : model.point) point.area *= 1.1;
  const auto changed = loop::retrace(d, {other});
  EXPECT_NE(changed.back().device.force, record.ticks.back().device.force);
}

// The controller's reductions are replayed; without them the force on the hand differs.
TEST(Replay, RetracesARunUnderThePassivityController) {
  scene::Description d = pressed();
  // reversing every other tick, where a sampled spring returns more energy than it received
  d.tool->coupling.damping_n_s_m = 0.0;
  const KeyframeSpec at = d.device->keyframes.front();
  d.device->keyframes.clear();
  for (int tick = 0; tick <= 200; ++tick) {
    d.device->keyframes.push_back(at);
    d.device->keyframes.back().time_s = 1e-3 * tick;
    d.device->keyframes.back().position_m.x() += tick % 2 ? 1e-3 : -1e-3;
    d.device->keyframes.back().interpolation = Interpolation::kLinear;
  }
  loop::HapticRecord record = recorded(d, false, "control.h5", {}, Passivity::kControl);
  EXPECT_EQ(record.passivity, Passivity::kControl);
  expect_equal(loop::retrace(d, {record}), record.ticks);
  record.passivity = Passivity::kOff;
  const auto without = loop::retrace(d, {record});
  double largest = 0.0;
  for (std::size_t i = 0; i < without.size(); ++i)
    largest = std::max(largest, (without[i].device.force - record.ticks[i].device.force).norm());
  EXPECT_GT(largest, 0.1) << "the controller did something";
}

// The same scene with the recorded hand gives the same run.
TEST(Replay, TheRecordedHandMovesAsTheHandDid) {
  const scene::Description d = pressed();
  const loop::HapticRecord first = recorded(d, false, "first.h5");
  const loop::HapticRecord repeated = recorded(d, false, "again.h5", loop::recorded_hand(first));
  expect_equal(repeated.ticks, first.ticks);
  EXPECT_EQ(repeated.start.handle.translation, first.start.handle.translation);
}

// Between ticks the hand is the cubic of its poses and twists; a minimum-jerk path differs from it by h^4 /
// 384 times its fourth derivative, 360 * 8 mm / (0.15 s)^4 at most: 1.5e-11 m for ticks of 1 ms.
TEST(Replay, TheRecordedHandIsSmoothBetweenTicks) {
  const scene::Description d = pressed();
  const auto hand = loop::recorded_hand(recorded(d, false, "smooth.h5"));
  double off = 0.0;
  for (int i = 1; i < 1400; ++i) {
    const double t = 1e-4 * i + 3e-5;
    const device::HandleSample s = hand->sample(t), truth = device::sample_keyframes(d.device->keyframes, t);
    off = std::max(off, (s.pose.translation - truth.pose.translation).norm());
    EXPECT_LT((s.twist.linear - truth.twist.linear).norm(), 1e-7);
  }
  EXPECT_LT(off, 1.6e-11);
  EXPECT_GT(off, 1e-14);
}

// Twists of a peer need not be the derivatives of its poses: for any twists the hand stays between its two
// ticks.
TEST(Replay, TheRecordedHandStaysBetweenTicks) {
  std::mt19937 rng(49);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vec = [&](double scale) {
    return Vec3(scale * uniform(rng), scale * uniform(rng), scale * uniform(rng));
  };
  loop::HapticRecord record;
  for (int i = 1; i <= 40; ++i) {
    loop::TickRecord tick;
    tick.length = i % 10 ? 1e-3 : 0.5;  // with pauses
    tick.time = (record.ticks.empty() ? 0.0 : record.ticks.back().time) + tick.length;
    tick.handle = {quaternion_of(vec(0.3)), vec(0.01)};
    tick.handle_twist = {vec(100.0), vec(10.0)};
    record.ticks.push_back(tick);
  }
  const auto path = loop::recorded_hand(record)->path();
  for (std::size_t i = 1; i < record.ticks.size(); ++i) {
    const loop::TickRecord &a = record.ticks[i - 1], &b = record.ticks[i];
    const Vec3 turn = pose_difference(a.handle, b.handle).head<3>();
    for (int k = 0; k <= 20; ++k) {
      const Pose pose = path(a.time + 0.05 * k * b.length).pose;
      const Vec3 turned = pose_difference(a.handle, pose).head<3>();
      for (int axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax(a.handle.translation[axis], b.handle.translation[axis]);
        EXPECT_GE(pose.translation[axis], low - 1e-15) << i;
        EXPECT_LE(pose.translation[axis], high + 1e-15) << i;
        EXPECT_GE(turned[axis], std::min(0.0, turn[axis]) - 1e-14) << i;
        EXPECT_LE(turned[axis], std::max(0.0, turn[axis]) + 1e-14) << i;
      }
    }
  }
}

// The force ramp after a pause is part of the recorded force.
TEST(Replay, RetracesAForceThatSetsInAnew) {
  scene::Description d = pressed();
  d.device->ramp_s = 0.02;
  loop::HapticRecord record = recorded(d, false, "ramped.h5");
  for (loop::TickRecord& tick : record.ticks)
    if (&tick - record.ticks.data() == 120) tick.ramps_in = true, tick.left_out = 77;
  const auto retraced = loop::retrace(d, {record});
  EXPECT_EQ(retraced[119].device.force, record.ticks[119].device.force);
  EXPECT_TRUE(retraced[120].ramps_in);
  EXPECT_EQ(retraced[120].left_out, 77u);
  EXPECT_EQ(retraced[120].device.force.norm(), 0.0);
  EXPECT_LT(retraced[125].device.force.norm(), 0.5 * record.ticks[125].device.force.norm());
  EXPECT_NEAR(retraced[145].device.force.norm(), record.ticks[145].device.force.norm(), 1e-12);
}

// Monolithic: one integrator follows the recorded hand at arbitrary times.
TEST(Replay, AnotherCouplingFollowsTheSameHand) {
  scene::Description d = pressed();
  const loop::HapticRecord record = recorded(d, false, "partitioned.h5");
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  d.integrator.name = "cvode-bdf";
  const loop::HapticRecord truth = recorded(d, false, "monolithic.h5");
  const loop::HapticRecord replayed = recorded(d, false, "replayed.h5", loop::recorded_hand(record));
  ASSERT_EQ(replayed.ticks.size(), truth.ticks.size());
  double off = 0.0;
  for (std::size_t i = 0; i < truth.ticks.size(); ++i)
    off = std::max(off, (replayed.ticks[i].device.force - truth.ticks[i].device.force).norm());
  EXPECT_LT(off, 1e-3 * peak(truth.ticks));
}

// One system, simulated again with the recorded lengths of the ticks: in real time as well, where a late tick
// covers several.
TEST(Replay, RetracesASingleRate) {
  scene::Description d = pressed();
  d.exchange.scheme = scene::ExchangeScheme::kSingleRate;
  for (const bool real_time : {false, true}) {
    const loop::HapticRecord record = recorded(d, real_time, "single.h5");
    const auto retraced = loop::retrace(d, {record});
    ASSERT_EQ(retraced.size(), record.ticks.size());
    EXPECT_GT(peak(record.ticks), 0.1);
    for (std::size_t i = 0; i < retraced.size(); ++i)
      ASSERT_EQ(retraced[i].device.force, record.ticks[i].device.force) << real_time << ", tick " << i;
  }
}

std::string refusal(const scene::Description& d, const loop::HapticRecord& record) {
  try {
    loop::retrace(d, {record});
  } catch (const Error& e) { return e.what(); }
  return {};
}

TEST(Replay, RefusesWhatItCannotRepeat) {
  const scene::Description d = pressed();
  const loop::HapticRecord record = recorded(d, false, "whole.h5");
  loop::HapticRecord holed = record;
  holed.ticks.erase(holed.ticks.begin() + 50);
  EXPECT_NE(refusal(d, holed).find("ticks are missing before t = 0.052 s"), std::string::npos);
  loop::HapticRecord unexchanged = record;
  unexchanged.exchanges.resize(3);
  EXPECT_NE(refusal(d, unexchanged).find("used exchange 4"), std::string::npos);
  loop::HapticRecord empty = record;
  empty.ticks.clear();
  EXPECT_NE(refusal(d, empty).find("no ticks"), std::string::npos);
  scene::Description one = d;
  one.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  EXPECT_NE(refusal(one, record).find("no exchange"), std::string::npos);
}

}  // namespace
