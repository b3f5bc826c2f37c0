#include "live/timing_window.h"

#include <gtest/gtest.h>

namespace palpate::live {
namespace {

TEST(TimeHistogram, QuantilesAreThoseOfTheValuesWithinItsResolution) {
  TimeHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.99), 0.0);
  for (int i = 1; i <= 1000; ++i) histogram.add(1e-6 * i);
  for (const double q : {0.5, 0.9, 0.99, 1.0})
    EXPECT_NEAR(histogram.quantile(q), 1e-3 * q, 0.04 * 1e-3 * q) << q;
  histogram.add(0.0);
  histogram.add(1e9);  // beyond its range: the last interval
  EXPECT_EQ(histogram.count(), 1002);
  EXPECT_EQ(histogram.quantile(0.0), 0.0);
  EXPECT_GT(histogram.quantile(1.0), 5.0);
}

TEST(TimingWindow, ReportsTheLastCompleteSecond) {
  TimingWindow window(1e-3);
  LiveStatus status;
  for (int i = 0; i <= 500; ++i) window.add(2e-3 * i, i % 10 == 0 ? 2e-3 : 1e-5, 4e-4, i % 10 == 0);
  window.write(status);
  EXPECT_NEAR(status.rate_hz, 501.0, 1e-6);
  EXPECT_NEAR(status.late_share, 51.0 / 501.0, 1e-9);
  EXPECT_NEAR(status.late_p99_s, 2e-3, 1e-4);
  EXPECT_NEAR(status.work_p50_s, 4e-4, 2e-5);
  EXPECT_EQ(status.skipped_ticks, 51);
}

}  // namespace
}  // namespace palpate::live
