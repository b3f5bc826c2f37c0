// Ticks by the machine's clock: two threads, one exchange. Times are not asserted; the tests assert that
// nothing is lost, torn or invented, whatever the machine does meanwhile.
#include "palpate/loop/real_time.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "palpate/core/error.h"
#include "palpate/device/device.h"
#include "palpate/loop/run.h"
#include "pressing_hand.h"
#include "small_scenes.h"

namespace {

using namespace palpate;
using pressing_hand::ball_on_floor;
using pressing_hand::scene_of;

TEST(Quantile, IsTheNearestRank) {
  const std::vector<float> values = {5, 1, 4, 2, 3};
  EXPECT_EQ(loop::quantile(values, 0.0), 1);
  EXPECT_EQ(loop::quantile(values, 0.5), 3);
  EXPECT_EQ(loop::quantile(values, 0.99), 5);
  EXPECT_EQ(loop::quantile(values, 1.0), 5);
  EXPECT_EQ(loop::quantile({}, 0.5), 0);
}

/// Records all ticks, and the times of periods.
struct Kept : loop::Observer {
  void tick(const loop::TickRecord& tick) override { ticks.push_back(tick); }
  void period(loop::World&, double t) override { periods.push_back(t); }
  std::vector<loop::TickRecord> ticks;
  std::vector<double> periods;
};

struct Ran {
  loop::RunResult result;
  Kept kept;
};

Ran run(const scene::Description& d, bool real_time) {
  const auto world = loop::assemble(d);
  Ran out;
  loop::RunOptions options;
  options.real_time = real_time;
  options.observers = {&out.kept};
  out.result = loop::run(*world, options);
  return out;
}

// Each tick is recorded once and in order, at its nominal time, whatever the clock did.
TEST(RealTime, EveryTickIsRecordedOnce) {
  const Ran r = run(scene_of(), true);
  ASSERT_TRUE(r.result.status.ok()) << r.result.status.message;
  ASSERT_TRUE(r.result.real_time);
  const loop::RealTimeResult& clock = *r.result.real_time;
  ASSERT_GT(r.kept.ticks.size(), 100u);
  for (std::size_t i = 0; i < r.kept.ticks.size(); ++i)
    EXPECT_NEAR(r.kept.ticks[i].time, static_cast<double>(i + 1) * clock.tick_s, 1e-12);
  EXPECT_EQ(clock.lateness_s.size(), r.kept.ticks.size());
  EXPECT_EQ(clock.unrecorded_ticks, 0);
  EXPECT_EQ(static_cast<long>(r.kept.ticks.size()), r.result.ticks);
  EXPECT_FALSE(clock.scheduling.empty());
  for (const float work : clock.work_s) EXPECT_GT(work, 0.0F);
  for (const float late : clock.lateness_s) EXPECT_GE(late, 0.0F);
}

// Versions of the active record only increase, the first tick has one, and no tick uses a record from after
// its time.
TEST(RealTime, RecordsAreAdoptedInOrder) {
  const Ran r = run(scene_of(), true);
  ASSERT_GT(r.kept.ticks.size(), 100u);
  EXPECT_GE(r.kept.ticks.front().record_version, 1u);
  EXPECT_TRUE(std::is_sorted(r.kept.ticks.begin(), r.kept.ticks.end(), [](const auto& a, const auto& b) {
    return a.record_version < b.record_version;
  }));
  EXPECT_GT(r.kept.ticks.back().record_version, 1u);
  // each exchange takes place at the end of a reported period, the first one at the start
  for (const loop::TickRecord& tick : r.kept.ticks)
    EXPECT_LT(r.kept.periods.at(tick.record_version - 1), tick.time);
}

// Real time lies between virtual time with a latency of one period, the largest of a bodies' thread that
// keeps up, and virtual time without latency, to the scatter of the clock. They differ in when records are
// adopted.
TEST(RealTime, FeelsWhatVirtualTimeFeels) {
  const auto in_time = [](const loop::RealTimeResult& clock) {
    return clock.stretched_periods + clock.dropped_periods == 0 &&
           loop::quantile(clock.latency_s, 1.0) <= clock.period_s;
  };
  Ran real = run(scene_of(), true);
  for (int i = 0; i < 10 && !in_time(*real.result.real_time); ++i) real = run(scene_of(), true);
  if (!in_time(*real.result.real_time)) GTEST_SKIP() << "the machine did not keep up in eleven runs";
  const Ran now = run(scene_of(), false);
  const Ran late = run(scene_of(10), false);
  ASSERT_EQ(real.kept.ticks.size(), now.kept.ticks.size());
  ASSERT_EQ(late.kept.ticks.size(), now.kept.ticks.size());
  double peak = 0.0, between = 0.0, off = 0.0;
  for (std::size_t i = 0; i < now.kept.ticks.size(); ++i) {
    const Vec3 &f = now.kept.ticks[i].device.force, &l = late.kept.ticks[i].device.force;
    peak = std::max(peak, f.norm());
    between = std::max(between, (f - l).norm());
    off = std::max(off, (f - real.kept.ticks[i].device.force).norm());
  }
  ASSERT_GT(peak, 0.1);
  EXPECT_GT(between, 0.0);
  EXPECT_LT(off, between + 0.05 * peak);
}

// A latency delays adoption by exactly its ticks.
TEST(VirtualTime, LatencyDelaysAdoption) {
  const Ran r = run(scene_of(3), false);
  const Ran at_once = run(scene_of(), false);
  ASSERT_GT(r.kept.ticks.size(), 100u);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(at_once.kept.ticks[i].record_version, i / 10 + 1) << i;
    EXPECT_EQ(r.kept.ticks[i].record_version, i < 13 ? 1 : (i - 3) / 10 + 1) << i;
  }
}

std::string refusal(const scene::Description& d, std::vector<loop::Observer*> observers = {}) {
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.real_time = true;
  options.observers = std::move(observers);
  try {
    loop::run(*world, options);
  } catch (const Error& e) { return e.what(); }
  return {};
}

TEST(RealTime, RefusesWhatItDoesNotServe) {
  EXPECT_NE(refusal(small_scenes::held_block()).find("no [tool]"), std::string::npos);
  scene::Description d = scene_of();
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  EXPECT_NE(refusal(d).find("use \"partitioned\""), std::string::npos);
}

// An obstacle needs no exchange: at rest the floor carries the hand's force, by either clock.
TEST(RealTime, TheToolMeetsObstacles) {
  for (const bool real_time : {false, true}) {
    const Ran r = run(ball_on_floor(), real_time);
    ASSERT_TRUE(r.result.status.ok()) << r.result.status.message;
    const loop::TickRecord& last = r.kept.ticks.back();
    EXPECT_GT(last.device.force.z(), 0.3) << real_time;
    EXPECT_NEAR(last.contact.force.z() / last.requested.force.z(), 1.0, 1e-3) << real_time;
  }
}

/// Records the energy balance of each period.
struct Weighs : loop::Observer {
  bool wants_energy() const override { return true; }
  void energy(const loop::EnergyBalance& balance) override { rows.push_back(balance); }
  std::vector<loop::EnergyBalance> rows;
};

// The energy balance of a real-time run follows from its ticks: the hand's work is theirs, and the stored
// energy equals that of virtual time if the bodies kept up.
TEST(RealTime, KeepsTheBalanceOfEnergy) {
  const auto balanced = [](bool real_time, Weighs& weighs, Kept& kept) {
    const auto world = loop::assemble(scene_of());
    loop::RunOptions options;
    options.real_time = real_time;
    options.observers = {&weighs, &kept};
    return loop::run(*world, options);
  };
  Weighs real, now;
  Kept kept, kept_now;
  const loop::RunResult r = balanced(true, real, kept);
  ASSERT_TRUE(r.status.ok()) << r.status.message;
  balanced(false, now, kept_now);
  double work = 0.0, power = 0.0, time = 0.0;
  for (const loop::TickRecord& tick : kept.ticks) {
    const double next = -tick.requested.force.dot(tick.handle_twist.linear) -
                        tick.requested.moment.dot(tick.handle_twist.angular);
    work += 0.5 * (tick.time - time) * (power + next);
    power = next;
    time = tick.time;
  }
  ASSERT_FALSE(real.rows.empty());
  EXPECT_GT(real.rows.back().hand, 1e-3);
  EXPECT_EQ(kept.periods.back(), real.rows.back().time);
  if (kept.periods.back() > time - 1e-9) { EXPECT_NEAR(real.rows.back().hand / work, 1.0, 1e-9); }
  if (r.real_time->stretched_periods + r.real_time->dropped_periods > 0 ||
      real.rows.size() != now.rows.size())
    GTEST_SKIP() << "the machine did not keep up";
  EXPECT_NEAR(real.rows.back().stored() / now.rows.back().stored(), 1.0, 0.05);
  EXPECT_LT(std::abs(real.rows.back().unaccounted - now.rows.back().unaccounted),
            0.05 * real.rows.back().hand);
}

/// A device that accepts forces, and fails from a given time on.
struct Feels : device::Device {
  explicit Feels(double when) : fails_at(when) {}
  device::DeviceSpecification specification() const override { return {}; }
  device::HandleSample do_sample(double t) override {
    if (t > fails_at) fail("the cable is out");
    device::HandleSample s;
    s.pose.translation = Vec3(0, 0, -0.1);
    return s;
  }
  void do_feedback(double, const Wrench& w) override {
    force = w.force;
    largest = std::max(largest, force.norm());
  }
  double fails_at, largest = 0.0;
  Vec3 force = Vec3::Zero();
};

// After its end a run exerts no force on any hand, by either clock, also if the device fails.
TEST(HapticLoop, EndsWithoutAForce) {
  for (const bool real_time : {false, true})
    for (const double fails_at : {1.0, 0.05}) {
      auto hand = std::make_unique<Feels>(fails_at);
      const Feels& feels = *hand;
      const auto world = loop::assemble(scene_of(), std::move(hand));
      loop::RunOptions options;
      options.real_time = real_time;
      options.duration_s = 0.1;
      std::string said;
      try {
        loop::run(*world, options);
      } catch (const Error& e) { said = e.what(); }
      EXPECT_EQ(said, fails_at < 0.1 ? "the cable is out" : "");
      EXPECT_GT(feels.largest, 0.1);
      EXPECT_EQ(feels.force.norm(), 0.0) << real_time << " " << fails_at;
    }
}

/// A stepper whose step ends only when it is interrupted.
struct Stuck : dynamics::Stepper {
  std::string name() const override { return "stuck"; }
  dynamics::StepResult advance_to(double t_end) override {
    dynamics::StepResult out;
    out.t = t_end;
    for (int i = 0; i < 60'000 && !interrupted(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    was_interrupted = interrupted();
    if (was_interrupted) out.status = dynamics::StepStatus::kInterrupted;
    return out;
  }
  bool dense_output(double, VecX&, VecX&) const override { return false; }
  void reinit(dynamics::ReinitReason) override {}
  const dynamics::StepperCounters& counters() const override { return counted; }
  dynamics::StepperCounters counted;
  bool was_interrupted = false;
};

// A step of the bodies that would take a minute is interrupted at the end of the run's time; the hand has had
// every tick, and the periods that the bodies missed are counted.
TEST(RealTime, EndsWhenItsTimeIsOver) {
  scene::Description d = scene_of();
  d.exchange.linearisation = "frozen";
  const auto world = loop::assemble(d);
  auto stepper = std::make_unique<Stuck>();
  const Stuck& stuck = *stepper;
  world->stepper = std::move(stepper);
  Kept kept;
  loop::RunOptions options;
  options.real_time = true;
  options.observers = {&kept};
  const loop::RunResult result = loop::run(*world, options);
  EXPECT_TRUE(stuck.was_interrupted);
  EXPECT_TRUE(result.status.ok()) << result.status.message;
  EXPECT_FALSE(result.stopped);
  EXPECT_EQ(kept.ticks.size(), 300u);
  EXPECT_NEAR(result.time, 0.3, 1e-12);
  EXPECT_EQ(result.real_time->dropped_periods, 30);
}

/// Holds still below the surface; at one tick it blocks for 0.1 s, as a stopped process.
struct Pauses : device::Device {
  device::DeviceSpecification specification() const override { return {}; }
  device::HandleSample do_sample(double t) override {
    if (t > 0.1495 && t < 0.1505) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    device::HandleSample s;
    s.pose.translation = Vec3(0.001, 0.002, 0.02);
    return s;
  }
};

// After a pause of 100 ticks the clock and the force ramp restart: missed ticks are not made up for. The
// machine may pause more often than the test does; each pause is treated the same way.
TEST(RealTime, ALongPauseIsNotMadeUpForInABurst) {
  scene::Description d = scene_of();
  d.device->ramp_s = 0.05;
  const auto world = loop::assemble(d, std::make_unique<Pauses>());
  Kept kept;
  loop::RunOptions options;
  options.real_time = true;
  options.observers = {&kept};
  const loop::RunResult result = loop::run(*world, options);
  ASSERT_TRUE(result.status.ok()) << result.status.message;
  ASSERT_EQ(kept.ticks.size(), 300u);
  const loop::RealTimeResult& clock = *result.real_time;
  long left_out = 0, stalls = 0;
  for (std::size_t i = 0; i < kept.ticks.size(); ++i) {
    const loop::TickRecord& tick = kept.ticks[i];
    EXPECT_NEAR(tick.time, 1e-3 * static_cast<double>(i + 1), 1e-12) << "the scene's time has no hole";
    EXPECT_EQ(tick.left_out > 0, static_cast<double>(clock.lateness_s[i]) > clock.stall_s) << i;
    if (tick.ramps_in) { EXPECT_EQ(tick.device.force.norm(), 0.0) << i; }
    left_out += tick.left_out;
    stalls += tick.ramps_in;
  }
  EXPECT_TRUE(kept.ticks[150].ramps_in) << "the one behind the pause";
  EXPECT_GE(kept.ticks[150].left_out, 90u);
  EXPECT_GT(kept.ticks[149].requested.force.norm(), 0.1);
  EXPECT_EQ(clock.left_out_ticks, left_out);
  EXPECT_EQ(clock.stalls, stalls);
}

/// Waits for a peer, and moves by the wall clock.
struct Awaits : Pauses {
  bool is_live() const override { return true; }
  std::string awaited() const override { return "somebody"; }
  void do_await(double, const std::atomic<bool>*) override { ++waited; }
  int waited = 0;
};

TEST(RealTime, WaitsForADeviceThatIsToComeAndVirtualTimeRefusesIt) {
  for (const bool real_time : {true, false}) {
    auto hand = std::make_unique<Awaits>();
    const Awaits& awaits = *hand;
    const auto world = loop::assemble(scene_of(), std::move(hand));
    std::string said, refused;
    loop::RunOptions options;
    options.real_time = real_time;
    options.duration_s = 0.05;
    options.waiting = [&](const std::string& what) { said += what; };
    try {
      loop::run(*world, options);
    } catch (const Error& e) { refused = e.what(); }
    EXPECT_EQ(awaits.waited, real_time ? 1 : 0);
    EXPECT_EQ(said, real_time ? "somebody" : "");
    EXPECT_EQ(refused.empty(), real_time);
    if (!real_time) {
      EXPECT_NE(refused.find("driven from outside, by the wall clock; run in real time"), std::string::npos)
          << refused;
    }
  }
}

// Outside the workspace the force on the handle is zero, and the run counts these ticks.
TEST(Run, CountsTicksOutsideTheWorkspace) {
  scene::Description d = scene_of();
  EXPECT_EQ(run(d, false).result.outside_ticks, 0);
  d.device->workspace_radius_m = 0.01;
  d.device->workspace_center_m = d.tool->position_m + Vec3(0.1, 0, 0);
  const Ran r = run(d, false);
  EXPECT_EQ(r.result.outside_ticks, 300);
  EXPECT_EQ(r.kept.ticks.back().device.force.norm(), 0.0);
  EXPECT_GT(r.kept.ticks.back().requested.force.norm(), 0.1);
}

}  // namespace
