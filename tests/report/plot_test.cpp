#include "report/plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "palpate/core/error.h"
#include "report/force_plot.h"
#include "report/thin.h"

using namespace palpate;
using nlohmann::json;
using report::Mark;
using report::Plot;

namespace {

Plot small_plot() {
  Plot plot;
  plot.title = "A title";
  plot.x_label = "CPU time [s]";
  plot.y_label = "error";
  plot.log_y = true;
  plot.levels = {{0.5, "a limit"}};
  plot.floor_y = 1e-6;
  plot.series.push_back({.name = "first",
                         .x = {1.0 / 3.0, 2.0, 3.0},
                         .y = {0.1, -1.0, 1e-300},
                         .mark = Mark::kLinePoints,
                         .labels = {"p0", "p1", "p2"},
                         .hollow = {true, false, false},
                         .group = "family",
                         .notes = {"a", "b", "c"}});
  plot.series.push_back({.name = "second", .x = {1.0}, .y = {1.0}, .mark = Mark::kDashed, .colour = "ink"});
  return plot;
}

std::string message_of(const Plot& plot) {
  try {
    report::plot_json(plot);
  } catch (const Error& e) { return e.what(); }
  return "no error";
}

}  // namespace

// Exact equality: the numbers on the page are those of the result.
TEST(Plot, HoldsTheNumbersThemselvesWithoutThoseThatCannotBeDrawn) {
  const json data = json::parse(report::plot_json(small_plot()));
  const json& first = data["series"][0];
  EXPECT_EQ(first["x"], (std::vector<double>{1.0 / 3.0, 3.0}));
  EXPECT_EQ(first["y"], (std::vector<double>{0.1, 1e-300})) << "-1 has no logarithm";
  EXPECT_EQ(first["labels"], (std::vector<std::string>{"p0", "p2"})) << "they stay beside their points";
  EXPECT_EQ(first["notes"], (std::vector<std::string>{"a", "c"}));
  EXPECT_EQ(first["hollow"], (std::vector<bool>{true, false}));
  EXPECT_EQ(first["mark"], "line-points");
  EXPECT_EQ(first["group"], "family");
  EXPECT_EQ(data["series"][1]["mark"], "dashed");
  EXPECT_EQ(data["title"], "A title");
  EXPECT_EQ(data["x_label"], "CPU time [s]");
  EXPECT_EQ(data["levels"][0]["y"], 0.5);
  EXPECT_EQ(data["levels"][0]["label"], "a limit");
  EXPECT_EQ(data["floor_y"], 1e-6);
  EXPECT_EQ(data["log_x"], false);
  EXPECT_EQ(data["log_y"], true);
}

TEST(Plot, LeavesOutAnEmptySeriesWithoutAColourForIt) {
  Plot plot = small_plot();
  plot.series[0].y = {-1.0, -2.0, -3.0};
  plot.series.push_back({.name = "third", .x = {1.0}, .y = {1.0}});
  plot.series.push_back({.name = "fourth", .x = {1.0}, .y = {1.0}});
  const json series = json::parse(report::plot_json(plot))["series"];
  ASSERT_EQ(series.size(), 3u);
  EXPECT_EQ(series[0]["colour"], "ink");
  EXPECT_EQ(series[1]["colour"], report::kPalette[0]);
  EXPECT_EQ(series[2]["colour"], report::kPalette[1]);
}

TEST(Plot, WritesAFloorThatIsNotThereAsNull) {
  Plot plot = small_plot();
  plot.floor_y = std::nan("");
  EXPECT_TRUE(json::parse(report::plot_json(plot))["floor_y"].is_null());
}

TEST(Plot, KeepsThePeakOfACurveThatIsThinned) {
  Plot plot;
  plot.series.push_back({.name = "long", .x = {}, .y = {}});
  for (int i = 0; i < 100'000; ++i) {
    plot.series[0].x.push_back(i);
    plot.series[0].y.push_back(i == 77'777 ? 5.0 : std::sin(i));
  }
  const std::vector<double> y = json::parse(report::plot_json(plot))["series"][0]["y"];
  EXPECT_LT(y.size(), 6100u);
  EXPECT_GT(y.size(), 1500u);
  EXPECT_EQ(*std::max_element(y.begin(), y.end()), 5.0);
}

TEST(Plot, SaysWhenThereIsNothingToDraw) {
  Plot plot = small_plot();
  plot.log_y = false;
  for (auto& s : plot.series) std::fill(s.y.begin(), s.y.end(), std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(message_of(plot), "plot \"A title\": there is nothing to draw: no point is finite");
  plot.log_x = true;
  EXPECT_NE(message_of(plot).find("and positive, as a logarithmic axis needs"), std::string::npos);
  EXPECT_NE(message_of(Plot{}).find("nothing to draw"), std::string::npos);
}

TEST(Plot, RefusesSeriesOfUnequalLengths) {
  Plot plot = small_plot();
  plot.series[0].y.pop_back();
  EXPECT_THROW(report::plot_json(plot), InternalError);
  plot = small_plot();
  plot.series[0].labels.pop_back();
  EXPECT_THROW(report::plot_json(plot), InternalError);
}

TEST(Thin, KeepsPeaksAndEnds) {
  std::vector<double> x, y;
  for (int i = 0; i < 100000; ++i) {
    x.push_back(i);
    y.push_back(std::sin(i * 1e-3));
  }
  y[12345] = 7.0;
  y[54321] = -7.0;
  report::thin(x, y, 500);
  EXPECT_LE(x.size(), 2000u);
  EXPECT_EQ(*std::max_element(y.begin(), y.end()), 7.0);
  EXPECT_EQ(*std::min_element(y.begin(), y.end()), -7.0);
  EXPECT_EQ(x.front(), 0.0);
  EXPECT_EQ(x.back(), 99999.0);
  EXPECT_TRUE(std::is_sorted(x.begin(), x.end()));
}

TEST(Thin, LeavesShortAndUnsortedCurvesAlone) {
  std::vector<double> x = {3, 1, 2}, y = {1, 2, 3};
  report::thin(x, y, 10);
  EXPECT_EQ(x.size(), 3u);
  std::vector<double> loop_x, loop_y;
  for (int i = 0; i < 1000; ++i) loop_x.push_back(std::cos(i)), loop_y.push_back(std::sin(i));
  report::thin(loop_x, loop_y, 10);
  EXPECT_EQ(loop_x.size(), 1000u);
}

TEST(ForcePlot, HasComponentsMagnitudeAndLimit) {
  report::Table table;
  table.headers = {"time_s", "force_x_n", "force_y_n", "force_z_n"};
  table.rows = {{"0", "3", "0", "4"}, {"1", "0", "-2", "0"}};
  const report::Plot plot = report::force_plot(table, 6.0);
  ASSERT_EQ(plot.series.size(), 4u);
  EXPECT_EQ(plot.series[3].y, (std::vector<double>{5.0, 2.0}));  // |(3, 0, 4)| = 5
  ASSERT_EQ(plot.levels.size(), 1u);
  EXPECT_EQ(plot.levels[0].label, "device limit 6 N");
  EXPECT_TRUE(report::force_plot(table, 0.0).levels.empty());
  EXPECT_THROW(report::torque_plot(table, 0.0), Error);
}
