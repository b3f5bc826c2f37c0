#include "report/clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "palpate/core/error.h"
#include "report/run_report.h"
#include "temporary_folder.h"
#include "well_formed.h"

using namespace palpate;

namespace {

std::string report_of(const TemporaryFolder& dir) {
  EXPECT_TRUE(report::write_run_report(dir.path()).missing_figures.empty());
  std::ifstream in(dir / "report.html", std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(LogHistogram, HasTenBinsADecadeWithTheirLowerEdge) {
  const report::LogHistogram h = report::log_histogram({10.0, 10.0, 12.5, 12.7, 99.0, 100.0});
  ASSERT_EQ(h.counts.size(), 11u);  // 10, 12.6, ... 79.4, 100
  ASSERT_EQ(h.edges.size(), 12u);
  EXPECT_EQ(h.counts, (std::vector<long>{3, 1, 0, 0, 0, 0, 0, 0, 0, 1, 1}));
  EXPECT_NEAR(h.edges[0], 10.0, 1e-12);
  EXPECT_NEAR(h.edges[1], 10.0 * std::pow(10.0, 0.1), 1e-12);
  EXPECT_NEAR(h.edges[10], 100.0, 1e-10);
}

TEST(LogHistogram, CountsEveryValueAndTheLeastInTheFirstBin) {
  std::vector<double> values = {0.0, -3.0, 0.05, 0.1};
  for (int i = 1; i <= 1000; ++i) values.push_back(0.37 * i);
  const report::LogHistogram h = report::log_histogram(values);
  long sum = 0;
  for (const long count : h.counts) sum += count;
  EXPECT_EQ(sum, 1004);
  EXPECT_EQ(h.counts[0], 4);
  EXPECT_NEAR(h.edges[0], 0.1, 1e-12);
  EXPECT_GT(h.edges.back(), 370.0);
  EXPECT_THROW(report::log_histogram({}), InternalError);
}

// 1 to 1000: nearest ranks are 500, 990, 999, 1000.
TEST(TickHistogram, MarksItsQuantiles) {
  std::vector<double> values;
  for (int i = 1000; i >= 1; --i) values.push_back(i);
  const report::Plot plot = report::tick_histogram(values, "tick late");
  EXPECT_EQ(plot.x_label, "tick late [µs]");
  EXPECT_TRUE(plot.log_x && plot.log_y);
  ASSERT_EQ(plot.series.size(), 5u);
  const char* names[] = {"p50 500 µs", "p99 990 µs", "p99.9 999 µs", "max 1 ms"};
  const double at[] = {500.0, 990.0, 999.0, 1000.0};
  const double highest = 1000.0 - 794.0;  // the bin from 794.3 holds 795 to 999
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(plot.series[i + 1].name, names[i]);
    EXPECT_EQ(plot.series[i + 1].x, (std::vector<double>{at[i], at[i]}));
    EXPECT_EQ(plot.series[i + 1].y[1], highest - 1.0);
  }
  // the bars' outline begins and ends below one tick, and reaches up to the fullest bin
  const report::Series& bars = plot.series[0];
  EXPECT_EQ(bars.mark, report::Mark::kArea);
  EXPECT_LT(bars.y.front(), 1.0);
  EXPECT_LT(bars.y.back(), 1.0);
  EXPECT_EQ(*std::max_element(bars.y.begin(), bars.y.end()), highest - 1.0);
}

TEST(TickHistogram, TicksThatAreNeverLateAreDrawnToo) {
  const report::Plot plot = report::tick_histogram({0.0, 0.0}, "tick late");
  EXPECT_EQ(plot.series[1].name, "p50 0 µs");
  EXPECT_NE(report::plot_json(plot).find("p50 0 µs"), std::string::npos);
}

TEST(RunReport, ShowsTheClockOfRealTime) {
  const TemporaryFolder dir;
  dir.write("clock.csv",
            "time_s,late_us,work_us\n0.001,3,40\n0.002,5,41\n0.003,4,39\n0.004,2000,45\n0.005,6,38\n");
  const std::string html = report_of(dir);
  EXPECT_EQ(well_formed_problem(html), "");
  for (const char* text : {"Ticks in real time", "Lateness of 5 ticks", "p50 5 µs", "max 2 ms", "p50 40 µs",
                           "max 45 µs", "[µs]"})
    EXPECT_NE(html.find(text), std::string::npos) << text;
  dir.write("clock.csv", "time_s,late_us,work_us\n");  // stopped before the first tick
  EXPECT_EQ(report_of(dir).find("Ticks in real time"), std::string::npos);
}

}  // namespace
