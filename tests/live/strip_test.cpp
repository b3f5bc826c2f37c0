#include <gtest/gtest.h>

#include <cmath>

#include "live/force_strip.h"

namespace palpate::live {
namespace {

Wrench pull(double newtons) {
  Wrench out;
  out.force = {0.0, 0.0, newtons};
  out.moment = {0.1 * newtons, 0.0, 0.0};
  return out;
}

TEST(ForceStrip, KeepsThePeakOfASingleTick) {
  ForceStrip strip(1);
  for (int i = 1; i <= 1000; ++i) strip.add(0, 1e-3 * i, pull(i == 437 ? -7.0 : 0.5));
  strip.add(0, 1.001, pull(0.0));
  int rows = 0;
  float most = 0.0F;
  double last = 0.0, at = 0.0;
  for (StripRow row; strip.pop(row); ++rows) {
    EXPECT_GE(row[0].time_s, last);
    last = row[0].time_s;
    if (std::abs(row[0].force[2]) > most) most = std::abs(row[0].force[2]), at = row[0].time_s;
    EXPECT_NEAR(row[0].torque[0], 0.1F * row[0].force[2], 1e-6F);
  }
  EXPECT_EQ(rows, 200) << "two in each 10 ms";
  EXPECT_EQ(most, 7.0F);
  EXPECT_NEAR(at, 0.437, 1e-12);
}

TEST(ForceStrip, HandsShareTheirRows) {
  ForceStrip strip(2);
  for (int i = 1; i <= 21; ++i)
    for (std::size_t hand = 0; hand < 2; ++hand)
      strip.add(hand, 1e-3 * i, pull(static_cast<double>(hand + 1) * (i == 5 ? 9.0 : 1.0)));
  int rows = 0, peaks = 0;
  for (StripRow row; strip.pop(row); ++rows) peaks += row[0].force[2] == 9.0F && row[1].force[2] == 18.0F;
  EXPECT_EQ(rows, 4);
  EXPECT_EQ(peaks, 1);
}

TEST(ForceStrip, RowsBeyondItsCapacityAreLostWithoutWaiting) {
  ForceStrip strip(1);
  for (int i = 1; i <= 60'000; ++i) strip.add(0, 1e-3 * i, pull(1.0));
  std::size_t rows = 0;
  for (StripRow row; strip.pop(row);) ++rows;
  EXPECT_EQ(rows, ForceStrip::kCapacity);
}

}  // namespace
}  // namespace palpate::live
