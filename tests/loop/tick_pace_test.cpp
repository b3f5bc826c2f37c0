// Ticks per step of the single-rate scheme in real time, on a simulated clock.
#include "loop/tick_pace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace {

using palpate::loop::TickPace;

constexpr std::int64_t kTick = 1'000'000;

struct Ran {
  long steps = 0, skipped = 0, lengths = 0;  ///< lengths: changes of the length of step
  std::int64_t latest = 0;
};

/// Runs a loop of `count` ticks. `work` is the time of a step, given the tick and whether the length of step
/// differs from that of the previous one.
Ran run(TickPace& pace, long count, const std::function<std::int64_t(long, bool)>& work) {
  Ran out;
  std::int64_t now = 0;
  long before = 1;
  for (long done = 0; done < count;) {
    const std::int64_t due = (done + pace.stride()) * kTick;
    now = std::max(now, due);
    out.latest = std::max(out.latest, now - due);
    long ticks = pace.begin(now - due);
    ticks += pace.stride();
    const bool changed = ticks != before;
    const std::int64_t took = work(done, changed);
    now += took;
    pace.end(took);
    out.skipped += ticks - 1;
    out.lengths += changed;
    ++out.steps;
    done += ticks;
    before = ticks;
  }
  return out;
}

TEST(TickPace, MakesUpForLongStepsWithoutSkipping) {
  TickPace pace(kTick, 10);
  const Ran ran = run(pace, 2000, [](long i, bool) { return i % 50 == 0 ? 3 * kTick : kTick / 2; });
  EXPECT_EQ(ran.skipped, 0);
  EXPECT_EQ(ran.steps, 2000);
  EXPECT_GT(ran.latest, kTick);
  EXPECT_LT(ran.latest, 3 * kTick);
}

// A step of another length costs more than a tick: a loop that changed it at each late tick would never be in
// time again.
TEST(TickPace, KeepsTheLengthOfStepUnderOverload) {
  TickPace pace(kTick, 10);
  const Ran ran = run(pace, 4000, [](long, bool changed) { return kTick * (changed ? 3 : 1) + kTick / 4; });
  EXPECT_EQ(pace.stride(), 2);
  EXPECT_LT(ran.lengths, 10);
  EXPECT_LT(ran.latest, (TickPace::kMostBehind + 4) * kTick);
  EXPECT_NEAR(static_cast<double>(ran.steps), 2000.0, 50.0);
}

TEST(TickPace, ReturnsToEveryTickAfterwards) {
  TickPace pace(kTick, 10);
  const Ran ran = run(pace, 6000, [](long i, bool) { return i < 1000 ? 2 * kTick : kTick / 2; });
  EXPECT_EQ(pace.stride(), 1);
  EXPECT_GT(ran.skipped, 500);
  const Ran later = run(pace, 1000, [](long, bool) { return kTick / 2; });
  EXPECT_EQ(later.skipped, 0);
}

TEST(TickPace, CoversAnInterruptionByOneStep) {
  TickPace pace(kTick, 10);
  const Ran ran = run(pace, 1000, [](long i, bool) { return i == 500 ? 8 * kTick : kTick / 2; });
  EXPECT_EQ(pace.stride(), 1);
  EXPECT_EQ(ran.steps, 1000 - ran.skipped);
  EXPECT_EQ(ran.skipped, 7);
  EXPECT_EQ(ran.lengths, 2);
}

TEST(TickPace, KeepsToTheLargestNumberOfTicks) {
  TickPace pace(kTick, 3);
  run(pace, 1000, [](long, bool) { return 20 * kTick; });
  EXPECT_EQ(pace.stride(), 3);
}

}  // namespace
