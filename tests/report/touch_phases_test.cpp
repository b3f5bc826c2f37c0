#include "report/touch_phases.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace palpate::report;

namespace {

/// A handle that moves for 0.1 s, rests for 0.1 s and moves back for 0.1 s, in ticks of 1 ms; contact from
/// `touch_s` to `free_s`.
TouchMotion press(double touch_s, double free_s, double rest_speed_m_s = 0.0) {
  TouchMotion out;
  for (int i = 1; i <= 300; ++i) {
    const double t = 1e-3 * i;
    out.time_s.push_back(t);
    out.speed_m_s.push_back(t > 0.1 && t <= 0.2 ? rest_speed_m_s : 0.2);
    out.contact_n.push_back(t > touch_s && t <= free_s ? 1.0 + std::sin(t) : 0.0);
  }
  return out;
}

}  // namespace

TEST(TouchPhases, AreThoseOfAPress) {
  const std::vector<Span> phases = touch_phases(press(0.06, 0.25));
  ASSERT_EQ(phases.size(), 5u);
  const char* names[] = {"approach", "touch", "hold", "release", "free"};
  const double ends[] = {0.001, 0.061, 0.101, 0.201, 0.251, 0.3};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(phases[i].label, names[i]);
    EXPECT_NEAR(phases[i].from, ends[i], 1e-9) << names[i];
    EXPECT_NEAR(phases[i].to, ends[i + 1], 1e-9) << names[i];
  }
}

TEST(TouchPhases, WithoutARestThereIsNoHold) {
  const std::vector<Span> phases = touch_phases(press(0.06, 0.25, 0.1));
  ASSERT_EQ(phases.size(), 3u);
  EXPECT_EQ(phases[0].label, "approach");
  EXPECT_EQ(phases[1].label, "touch");
  EXPECT_NEAR(phases[1].to, 0.251, 1e-9);
  EXPECT_EQ(phases[2].label, "free");
}

TEST(TouchPhases, AreCutAtTheEndsOfTheRun) {
  const std::vector<Span> phases = touch_phases(press(-1.0, 1.0));
  ASSERT_EQ(phases.size(), 3u);
  EXPECT_EQ(phases.front().label, "touch");
  EXPECT_EQ(phases.back().label, "release");
  EXPECT_NEAR(phases.back().to, 0.3, 1e-9);
}

TEST(TouchPhases, WithoutContactThereAreNone) {
  EXPECT_TRUE(touch_phases(press(1.0, 2.0)).empty());
  EXPECT_TRUE(touch_phases({}).empty());
}
