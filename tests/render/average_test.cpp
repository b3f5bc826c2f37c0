#include "render/average.h"

#include <gtest/gtest.h>

using namespace palpate;

TEST(Average, IsTakenInLinearLightAndTurnsRowsOver) {
  // Two pixels, one above the other, of 2 x 2 samples; rows from below. Lower: half black, half white. Upper:
  // level 200 throughout.
  std::vector<std::uint8_t> samples(2 * 4 * 4, 255);
  for (const int i : {0, 2})
    for (int c = 0; c < 3; ++c) samples[static_cast<std::size_t>(4 * i + c)] = 0;
  for (int i = 4; i < 8; ++i)
    for (int c = 0; c < 3; ++c) samples[static_cast<std::size_t>(4 * i + c)] = 200;
  const render::Picture picture = render::average(samples, 1, 2, 2);
  EXPECT_EQ(picture.pixel(0, 0)[0], 200);
  // Half of full intensity: IEC 61966-2-1 gives 255 (1.055 0.5^(1/2.4) - 0.055) = 187.5.
  EXPECT_NEAR(picture.pixel(0, 1)[0], 187.5, 0.6);
  EXPECT_EQ(picture.pixel(0, 0)[3], 255);
}

TEST(Average, KeepsEveryLevelOfOneSample) {
  std::vector<std::uint8_t> samples;
  for (int level = 0; level < 256; ++level)
    for (int c = 0; c < 4; ++c) samples.push_back(static_cast<std::uint8_t>(level));
  const render::Picture picture = render::average(samples, 256, 1, 1);
  for (int level = 0; level < 256; ++level) EXPECT_EQ(picture.pixel(level, 0)[1], level);
}
