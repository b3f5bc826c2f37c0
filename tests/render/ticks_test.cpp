#include "render/ticks.h"

#include <gtest/gtest.h>

#include "palpate/core/error.h"

using namespace palpate;

TEST(RoundUp, GivesOneTwoOrFive) {
  EXPECT_DOUBLE_EQ(render::round_up(0.0101), 0.02);
  EXPECT_DOUBLE_EQ(render::round_up(0.01), 0.01);
  EXPECT_DOUBLE_EQ(render::round_up(3.0), 5.0);
  EXPECT_DOUBLE_EQ(render::round_up(700.0), 1000.0);
  EXPECT_THROW(render::round_up(0.0), InternalError);
}

TEST(ScaledUnit, TakesThePrefixThatReadsBest) {
  EXPECT_EQ(render::scaled_unit("m", 0.004).name, "mm");
  EXPECT_EQ(render::scaled_unit("m", 0.004).factor, 1e3);
  EXPECT_EQ(render::scaled_unit("Pa", 2.3e5).name, "kPa");
  EXPECT_EQ(render::scaled_unit("Pa", 2.3e6).name, "MPa");
  EXPECT_EQ(render::scaled_unit("N", 3.3).name, "N");
  EXPECT_EQ(render::scaled_unit("m", 2e-6).name, "µm");
  EXPECT_EQ(render::scaled_unit("%", 1e-5).name, "%");
  EXPECT_EQ(render::scaled_unit("m", 0.0).factor, 1.0);
}

TEST(Ticks, AreRoundAndFewAndInside) {
  const auto ticks = render::ticks(0.0, 0.018, render::scaled_unit("m", 0.018));  // 18 mm: steps of 5
  ASSERT_EQ(ticks.size(), 4u);
  EXPECT_EQ(ticks[0].text, "0");
  EXPECT_EQ(ticks[3].text, "15");
  EXPECT_NEAR(ticks[3].value, 0.015, 1e-15);
  for (const double high : {1.0, 1.1, 2.3, 3.7, 4.9, 6.1, 9.99}) {
    const auto t = render::ticks(0.0, high, {});
    EXPECT_GE(t.size(), 3u) << high;
    EXPECT_LE(t.size(), 7u) << high;
    EXPECT_LE(t.back().value, high * (1 + 1e-9));
  }
}

TEST(Ticks, CrossZeroWithoutASign) {
  const auto ticks = render::ticks(-1.0, 1.0, {});
  int zeros = 0;
  for (const auto& tick : ticks) zeros += tick.text == "0.0";
  EXPECT_EQ(zeros, 1);
}
