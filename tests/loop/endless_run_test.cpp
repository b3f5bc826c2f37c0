// Runs in real time without an end, and pauses.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "loop/timing_series.h"
#include "messages.h"
#include "palpate/core/error.h"
#include "palpate/device/device.h"
#include "palpate/loop/run.h"
#include "pressing_hand.h"

namespace {

using namespace palpate;
using Scheme = scene::ExchangeScheme;

constexpr double kEndless = std::numeric_limits<double>::infinity();

TEST(TimingSeries, KeepsTheNewestInTheirOrder) {
  std::vector<float> values;
  long count = 0;
  loop::TimingSeries series(values, count, 4);
  for (int i = 1; i <= 10; ++i) series.add(static_cast<float>(i));
  series.close();
  EXPECT_EQ(values, (std::vector<float>{7, 8, 9, 10}));
  EXPECT_EQ(count, 10);
}

TEST(TimingSeries, KeepsAllOfAShortRun) {
  std::vector<float> values;
  long count = 0;
  loop::TimingSeries series(values, count, 4);
  for (int i = 1; i <= 3; ++i) series.add(static_cast<float>(i));
  series.close();
  EXPECT_EQ(values, (std::vector<float>{1, 2, 3}));
}

/// Ends a run after a number of ticks, and pauses it at another.
struct Conductor : loop::Observer {
  void tick(const loop::TickRecord& tick) override {
    ticks.push_back(tick);
    if (ticks.size() == pause_at) pause = true;
    if (ticks.size() >= stop_at) stop = true;
  }
  void timed(const loop::TickTiming& one) override {
    EXPECT_GE(one.lateness_s, 0.0F);
    EXPECT_GT(one.work_s, 0.0F);
    ++timings;
  }
  std::vector<loop::TickRecord> ticks;
  std::size_t pause_at = 0, stop_at = 0;
  long timings = 0;
  std::atomic<bool> pause{false}, stop{false};
};

class Endless : public testing::TestWithParam<Scheme> {
 protected:
  Endless() {
    scene::Description d = pressing_hand::scene_of();
    d.exchange.scheme = GetParam();
    world = loop::assemble(d);
    options.duration_s = kEndless;
    options.real_time = true;
    options.observers = {&conductor};
    options.stop = &conductor.stop;
    options.pause = &conductor.pause;
  }
  std::unique_ptr<loop::World> world;
  Conductor conductor;
  loop::RunOptions options;
};

TEST_P(Endless, ARunEndsWhenItIsStopped) {
  const double scene_s = world->description.duration_s;
  conductor.stop_at = static_cast<std::size_t>(1.5 * scene_s / world->description.tool->tick_s);
  const loop::RunResult result = loop::run(*world, options);
  ASSERT_TRUE(result.status.ok()) << result.status.message;
  EXPECT_TRUE(result.stopped);
  EXPECT_GT(conductor.ticks.back().time, 1.4 * scene_s) << "beyond the scene's duration";
  ASSERT_TRUE(result.real_time);
  EXPECT_EQ(result.real_time->timed_ticks, static_cast<long>(conductor.ticks.size()));
  EXPECT_EQ(conductor.timings, static_cast<long>(conductor.ticks.size()));
  EXPECT_EQ(result.real_time->lateness_s.size(), conductor.ticks.size());
}

TEST_P(Endless, VirtualTimeIsRejected) {
  options.real_time = false;
  EXPECT_NE(expectations::message_of([&] { loop::run(*world, options); }).find("duration_s = inf"),
            std::string::npos);
}

TEST_P(Endless, APauseHoldsTheClockAndTheForceRampsInAfterIt) {
  conductor.pause_at = 60;
  conductor.stop_at = 200;
  std::size_t before = 0, after = 0;
  std::thread viewer([&] {
    while (!conductor.pause) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // ticks before it are recorded
    before = conductor.ticks.size();
    std::this_thread::sleep_for(std::chrono::milliseconds(250));
    after = conductor.ticks.size();
    conductor.pause = false;
  });
  const loop::RunResult result = loop::run(*world, options);
  viewer.join();
  ASSERT_TRUE(result.status.ok()) << result.status.message;
  EXPECT_EQ(before, after) << "no tick in the pause";
  EXPECT_GE(before, 60U);
  ASSERT_GT(conductor.ticks.size(), after);
  // In the partitioned scheme observers get the ticks of a period together, up to four periods late.
  const auto first = conductor.ticks.begin() + static_cast<std::ptrdiff_t>(after);
  const auto last = first + std::min<std::ptrdiff_t>(60, conductor.ticks.end() - first);
  EXPECT_TRUE(std::any_of(first, last, [](const loop::TickRecord& tick) { return tick.ramps_in; }));
  // Simulated time goes on where it was, but for ticks that a late machine skips.
  EXPECT_LT(conductor.ticks[after].time - conductor.ticks[after - 1].time, 0.1);
}

TEST_P(Endless, APausedRunCanBeStopped) {
  conductor.pause = true;
  std::thread viewer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    conductor.stop = true;
  });
  const loop::RunResult result = loop::run(*world, options);
  viewer.join();
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(conductor.ticks.size(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Schemes, Endless, testing::Values(Scheme::kPartitioned, Scheme::kSingleRate),
                         [](const auto& one) {
                           return one.param == Scheme::kPartitioned ? "partitioned" : "single_rate";
                         });

}  // namespace
