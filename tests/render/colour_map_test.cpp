#include "render/colour_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/object_colours.h"
#include "palpate/core/error.h"

using namespace palpate;

namespace {

/// CIE 1976 lightness of an sRGB colour (IEC 61966-2-1, D65).
double lightness(render::Rgb c) {
  const auto linear = [](double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); };
  const double y = 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
  return y > 0.008856 ? 116.0 * std::cbrt(y) - 16.0 : 903.3 * y;
}

}  // namespace

TEST(Ramp, GrowsDarkerInEvenSteps) {
  // From a pale body to a dark one: a fifth of the lightness is left for shading below the darkest colour.
  const double low = lightness(render::ramp(0.0)), high = lightness(render::ramp(1.0));
  EXPECT_GT(low, 80.0);
  EXPECT_GT(high, 20.0);
  for (int i = 0; i <= 100; ++i) {
    const double t = i / 100.0;
    EXPECT_NEAR(lightness(render::ramp(t)), low + t * (high - low), 2.5) << t;
    EXPECT_LT(lightness(render::ramp(t + 0.005)), lightness(render::ramp(t - 0.005))) << t;
  }
}

TEST(Ramp, EndsAtTheColoursOfTheTable) {
  for (const auto& [t, name] : {std::pair{0.0, colours::kRamp.front()}, {1.0, colours::kRamp.back()}}) {
    const render::Rgb drawn = render::ramp(t), listed = render::colour_of(name);
    EXPECT_EQ(drawn.r, listed.r);
    EXPECT_EQ(drawn.g, listed.g);
    EXPECT_EQ(drawn.b, listed.b);
  }
  EXPECT_EQ(colours::kBody, colours::kRamp.front());  // an unloaded body has the colour of one without values
}

TEST(Ramp, ClampsItsArgument) {
  EXPECT_EQ(render::ramp(-3.0).r, render::ramp(0.0).r);
  EXPECT_EQ(render::ramp(2.0).b, render::ramp(1.0).b);
}

TEST(ColourOf, ReadsHexadecimalDigits) {
  const render::Rgb c = render::colour_of("#ff8000");
  EXPECT_EQ(c.r, 1.0f);
  EXPECT_EQ(c.g, 128.0f / 255.0f);
  EXPECT_EQ(c.b, 0.0f);
  for (const char* bad : {"ff8000", "#ff800", "#ff80gg", "#FF8000"})
    EXPECT_THROW(render::colour_of(bad), InternalError) << bad;
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
