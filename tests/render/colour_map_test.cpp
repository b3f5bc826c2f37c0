#include "render/colour_map.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace palpate;

namespace {

/// CIE 1976 lightness of an sRGB colour (IEC 61966-2-1, D65).
double lightness(render::Rgb c) {
  const auto linear = [](double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); };
  const double y = 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
  return y > 0.008856 ? 116.0 * std::cbrt(y) - 16.0 : 903.3 * y;
}

}  // namespace

TEST(Viridis, FollowsThePublishedColours) {
  // #440154, #3b528b, #21918c, #5ec962, #fde725 at 0, 1/4, 1/2, 3/4, 1
  const int published[5][3] = {
      {0x44, 0x01, 0x54}, {0x3b, 0x52, 0x8b}, {0x21, 0x91, 0x8c}, {0x5e, 0xc9, 0x62}, {0xfd, 0xe7, 0x25}};
  for (int i = 0; i < 5; ++i) {
    const render::Rgb c = render::viridis(i / 4.0);
    EXPECT_NEAR(c.r, published[i][0] / 255.0, 0.02) << i;
    EXPECT_NEAR(c.g, published[i][1] / 255.0, 0.02) << i;
    EXPECT_NEAR(c.b, published[i][2] / 255.0, 0.02) << i;
  }
}

TEST(Viridis, GrowsLighterInEvenSteps) {
  // The published map is linear in lightness, from 15 to 91.
  const double low = lightness(render::viridis(0.0)), high = lightness(render::viridis(1.0));
  for (int i = 0; i <= 100; ++i) {
    const double t = i / 100.0;
    EXPECT_NEAR(lightness(render::viridis(t)), low + t * (high - low), 2.5) << t;
    EXPECT_GT(lightness(render::viridis(t + 0.005)), lightness(render::viridis(t - 0.005))) << t;
  }
}

TEST(Viridis, ClampsItsArgument) {
  EXPECT_EQ(render::viridis(-3.0).r, render::viridis(0.0).r);
  EXPECT_EQ(render::viridis(2.0).b, render::viridis(1.0).b);
}

TEST(Settled, FillsOpenEndsAndIsFinite) {
  const render::ColourScale open = render::settled({"a", "m"}, -1.0, 3.0);
  EXPECT_EQ(open.low, -1.0);
  EXPECT_EQ(open.high, 3.0);
  const render::ColourScale half = render::settled({"a", "m", 0.0}, -1.0, 3.0);
  EXPECT_EQ(half.low, 0.0);
  EXPECT_EQ(half.high, 3.0);
  EXPECT_FALSE(open.is_flat());
  const render::ColourScale flat = render::settled({"a", "m"}, 2.0, 2.0);
  EXPECT_TRUE(flat.is_flat());
  EXPECT_EQ(flat.low, 2.0);
  // no finite value
  const render::ColourScale none = render::settled({"a", "m"}, INFINITY, -INFINITY);
  EXPECT_TRUE(none.is_flat());
  EXPECT_TRUE(std::isfinite(none.low));
}

TEST(Settled, RoundingIsOneColour) {
  render::ColourScale scale{"a", "m"};
  scale.resolution = 1e-9;
  const render::ColourScale rest = render::settled(scale, 2e-18, 2.5e-17);  // a body at rest
  EXPECT_TRUE(rest.is_flat());
  EXPECT_EQ(rest.high, 0.0);
  EXPECT_EQ(render::share(rest, 2.5e-17), 0.0);
  const render::ColourScale shifted = render::settled(scale, 0.25, 0.25 + 1e-12);
  EXPECT_TRUE(shifted.is_flat());
  EXPECT_EQ(shifted.low, 0.25);
  const render::ColourScale moved = render::settled(scale, 0.0, 2e-9);
  EXPECT_FALSE(moved.is_flat());
  EXPECT_NEAR(render::share(moved, 5e-10), 0.25, 1e-12);
  EXPECT_EQ(render::share(moved, 1.0), 1.0);
}
