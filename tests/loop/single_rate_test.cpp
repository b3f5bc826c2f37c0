// Tools and bodies as one system, one step per haptic tick, with a sampled handle.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "core/counters.h"
#include "loop/choose_scheme.h"
#include "palpate/core/error.h"
#include "palpate/device/device.h"
#include "palpate/loop/run.h"
#include "pressing_hand.h"
#include "ticks_of.h"

namespace {

using namespace palpate;
using Scheme = scene::ExchangeScheme;

/// A hand that presses the block aside of its centre, and moves along it.
scene::Description press(Scheme scheme, double tick_s = 1e-3) {
  scene::Description d = pressing_hand::scene_of();
  d.duration_s = 0.1;
  d.device->keyframes.back().time_s = 0.06;
  d.device->keyframes.back().position_m.x() += 0.002;
  d.contacts[0].method = "distance";
  d.tool->tick_s = tick_s;
  d.exchange.scheme = scheme;
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.01;
  d.integrator.step_s = tick_s;
  d.integrator.linear_rtol = 1e-8;
  return d;
}

/// Accurate solution of the same system with the same ticks.
std::vector<loop::TickRecord> reference(double tick_s) {
  scene::Description d = press(Scheme::kMonolithic, tick_s);
  d.integrator.name = "cvode-bdf";
  d.integrator.rtol = 1e-7;
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.002;
  return ticks_of(d);
}

/// RMS difference of the forces on the hand, relative to the peak of the second.
double difference(const std::vector<loop::TickRecord>& a, const std::vector<loop::TickRecord>& b) {
  EXPECT_EQ(a.size(), b.size());
  double sum = 0.0, peak = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    sum += (a[i].requested.force - b[i].requested.force).squaredNorm();
    peak = std::max(peak, b[i].requested.force.norm());
  }
  EXPECT_GT(peak, 0.1);
  return std::sqrt(sum / static_cast<double>(b.size())) / peak;
}

TEST(SingleRate, ExchangesNothing) {
  counters::reset();
  const auto ticks = ticks_of(press(Scheme::kSingleRate));
  EXPECT_EQ(ticks.size(), 100u);
  EXPECT_EQ(counters::counter("loop.exchange_record"), 0);
  EXPECT_EQ(counters::counter("loop.condenser"), 0);
  EXPECT_EQ(counters::counter("integrate.linearly-implicit-euler"), 1);
  counters::reset();
  ticks_of(press(Scheme::kPartitioned));
  EXPECT_GT(counters::counter("loop.exchange_record"), 0) << "the counters count";
}

// One linearly implicit step per tick is of order 1: half the tick, half the error.
TEST(SingleRate, ConvergesToTheMonolithicSolutionWithTheTick) {
  const double coarse = difference(ticks_of(press(Scheme::kSingleRate, 1e-3)), reference(1e-3)),
               fine = difference(ticks_of(press(Scheme::kSingleRate, 2.5e-4)), reference(2.5e-4));
  EXPECT_LT(coarse, 0.03);
  EXPECT_LT(fine, 0.35 * coarse);
  EXPECT_GT(fine, 0.15 * coarse) << "not limited by anything else";
  const double partitioned = difference(ticks_of(press(Scheme::kPartitioned, 2.5e-4)), reference(2.5e-4));
  EXPECT_LT(fine, 0.7 * partitioned) << "an exchange every 10 ms has another error, which remains";
}

// With error control in each tick only the interpolation of the handle is left.
TEST(SingleRate, RunsEveryIntegrator) {
  for (const char* integrator : {"cvode-bdf", "ark-dirk-cash534", "implicit-midpoint", "bdf2"}) {
    scene::Description d = press(Scheme::kSingleRate);
    d.integrator.name = integrator;
    d.integrator.rtol = 1e-5;
    EXPECT_LT(difference(ticks_of(d), reference(1e-3)), 0.01) << integrator;
  }
}

// A duration that is no multiple of the period ends with a shorter period.
TEST(SingleRate, EndsAtTheDuration) {
  scene::Description d = press(Scheme::kSingleRate);
  d.duration_s = 0.0345;
  for (const bool real_time : {false, true}) {
    const auto world = loop::assemble(d);
    Ticks ticks;
    loop::RunOptions options;
    options.real_time = real_time;
    options.observers = {&ticks};
    const loop::RunResult result = loop::run(*world, options);
    ASSERT_TRUE(result.status.ok()) << result.status.message;
    EXPECT_EQ(result.periods, 4);
    EXPECT_EQ(world->state.time(), 0.0345);
    EXPECT_EQ(ticks.all.back().time, 0.0345);
    EXPECT_LE(ticks.all.size(), 35u);
  }
}

/// Hand without a path known in advance, which jumps at one tick.
class Jumps : public device::Device {
 public:
  Jumps(Vec3 start, double at) : start_(std::move(start)), at_(at) {}
  device::DeviceSpecification specification() const override { return {}; }
  long samples = 0;

 private:
  device::HandleSample do_sample(double t) override {
    ++samples;
    device::HandleSample out;
    out.pose.translation = start_ + Vec3(0.0, 0.0, t < at_ ? 0.0 : -0.001);
    return out;
  }
  Vec3 start_;
  double at_;
};

// The wrench of a tick belongs to the handle of that tick, sampled once: the spring's share of the jump
// arrives in the tick that samples it, and the tool has moved by then.
TEST(SingleRate, AWrenchIsOneTickOld) {
  scene::Description d = press(Scheme::kSingleRate);
  auto hand = std::make_unique<Jumps>(d.tool->position_m, 0.05 - 1e-9);
  Jumps& jumps = *hand;
  const auto world = loop::assemble(d, std::move(hand));
  const auto ticks = ticks_of(*world);
  ASSERT_EQ(ticks.size(), 100u);
  EXPECT_EQ(jumps.samples, 101);
  const double before = ticks[48].requested.force.z(), after = ticks[49].requested.force.z(),
               spring = d.tool->coupling.stiffness_n_m * 1e-3;
  EXPECT_GT(after - before, 0.7 * spring);
  EXPECT_LT(after - before, 0.99 * spring) << "a tool of 50 g has followed by h^2 k / m";
  EXPECT_LT(ticks[49].tool_twist.linear.z(), -1e-3);
  EXPECT_NEAR(ticks[48].tool_twist.linear.z(), 0.0, 1e-5) << "it was at rest";
  scene::Description one = d;
  one.exchange.scheme = Scheme::kMonolithic;
  EXPECT_THROW(loop::assemble(one, std::make_unique<Jumps>(d.tool->position_m, 0.05)), Error);
}

// The mean of the motors, delays and the passivity controller are those of a sampled device.
TEST(SingleRate, HasTheMotorsOfASampledHand) {
  const auto run_with_delay = [](double delay) {
    scene::Description d = press(Scheme::kSingleRate);
    d.device->type = "hand";
    d.device->delay_s = delay;
    return ticks_of(d);
  };
  const auto prompt = run_with_delay(0.0), late = run_with_delay(3e-3);
  double apart = 0.0;
  for (std::size_t i = 10; i < prompt.size(); ++i) {
    apart = std::max(apart, (late[i].motors.force - prompt[i].motors.force).norm());
    EXPECT_LT((late[i].motors.force - late[i - 4].device.force).norm(), 1e-9) << i;
  }
  EXPECT_GT(apart, 1e-3);
}

TEST(SingleRate, DoesNotDependOnThreads) {
  const auto with = [](int threads) {
    scene::Description d = press(Scheme::kSingleRate);
    d.bodies[0].mesh.element_size_m = 0.003;
    d.duration_s = 0.04;
    d.integrator.threads = threads;
    return ticks_of(d);
  };
  const auto one = with(1), two = with(2);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one[i].requested.force, two[i].requested.force) << i;
}

// The choice of "auto": no machine steps a block in half a microsecond, and each does in 20 ms.
TEST(SingleRate, IsChosenWhereAStepFitsATick) {
  for (const double tick_s : {1e-6, 0.04}) {
    scene::Description d = press(Scheme::kAuto, tick_s);
    d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 10 * tick_s;
    const loop::SchemeChoice choice = loop::choose_scheme(d);
    const bool fits = tick_s > 1e-3;
    EXPECT_EQ(choice.scheme, fits ? Scheme::kSingleRate : Scheme::kPartitioned);
    EXPECT_GT(choice.step_s, 0.5e-6);
    EXPECT_LT(choice.step_s, 0.02);
    EXPECT_NE(choice.text().find(fits ? "single_rate, because" : "partitioned, because"), std::string::npos)
        << choice.text();
    const auto world = loop::assemble(d);
    EXPECT_EQ(world->description.exchange.scheme, choice.scheme);
    EXPECT_EQ(world->monolithic(), fits);
  }
}

/// Keeps ticks, and holds the loop up at some periods.
struct Slow : Ticks {
  explicit Slow(std::chrono::milliseconds by) : delay(by) {}
  void period(loop::World& world, double t) override {
    times.push_back(t);
    time = world.state.time();
    if (times.size() % 4 == 2) std::this_thread::sleep_for(delay);
  }
  std::chrono::milliseconds delay;
  std::vector<double> times;
  double time = 0.0;
};

// A late tick steps over those that it missed: nothing is lost, the run stays with the clock, and each record
// says how long its step was.
TEST(SingleRate, ALateTickCoversTheMissedOnes) {
  const auto world = loop::assemble(press(Scheme::kSingleRate));
  Slow slow(std::chrono::milliseconds(8));
  loop::RunOptions options;
  options.real_time = true;
  options.observers = {&slow};
  const loop::RunResult result = loop::run(*world, options);
  ASSERT_TRUE(result.status.ok()) << result.status.message;
  ASSERT_TRUE(result.real_time);
  const loop::RealTimeResult& clock = *result.real_time;
  EXPECT_NEAR(slow.time, 0.1, 1e-12);
  EXPECT_NEAR(slow.all.back().time, 0.1, 1e-12);
  EXPECT_GE(clock.skipped_ticks + clock.left_out_ticks, 7);
  EXPECT_EQ(static_cast<long>(slow.all.size()) + clock.skipped_ticks, 100);
  double end = 0.0;
  for (const loop::TickRecord& tick : slow.all) {
    EXPECT_NEAR(tick.time - tick.length, end, 1e-12);
    EXPECT_TRUE(tick.device.force.allFinite());
    end = tick.time;
  }
}

// In real time every tick sends its own wrench, and the forces are those of virtual time where none is
// skipped.
TEST(SingleRate, RealTimeGivesTheForcesOfVirtualTime) {
  const auto now = ticks_of(press(Scheme::kSingleRate));
  for (int attempt = 0; attempt < 10; ++attempt) {
    const auto world = loop::assemble(press(Scheme::kSingleRate));
    Ticks ticks;
    loop::RunOptions options;
    options.real_time = true;
    options.observers = {&ticks};
    const loop::RunResult result = loop::run(*world, options);
    ASSERT_TRUE(result.status.ok()) << result.status.message;
    ASSERT_EQ(result.real_time->lateness_s.size(), ticks.all.size());
    if (ticks.all.size() != now.size()) continue;
    for (std::size_t i = 0; i < now.size(); ++i)
      EXPECT_LT((ticks.all[i].requested.force - now[i].requested.force).norm(), 1e-9) << i;
    return;
  }
  GTEST_SKIP() << "the machine did not keep up in ten runs";
}

}  // namespace
