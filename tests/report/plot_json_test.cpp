#include "report/plot_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "palpate/core/error.h"

using namespace palpate;
using nlohmann::json;
using report::Mark;
using report::Plot;

namespace {

Plot small_plot() {
  Plot plot;
  plot.x_label = "CPU time [s]";
  plot.y_label = "error";
  plot.log_y = true;
  plot.levels = {{0.5, "a bar"}};
  plot.floor_y = 1e-6;
  plot.series.push_back({.name = "first",
                         .x = {1.0 / 3.0, 2.0, 3.0},
                         .y = {0.1, -1.0, 1e-300},
                         .mark = Mark::kLinePoints,
                         .hollow = {true, false, false},
                         .group = "family",
                         .notes = {"a", "b", "c"}});
  plot.series.push_back({.name = "second", .x = {1.0}, .y = {1.0}, .colour = "ink"});
  return plot;
}

}  // namespace

// Exact equality: the numbers on the page are those of the result.
TEST(PlotJson, HoldsTheNumbersThemselvesWithoutThoseThatCannotBeDrawn) {
  const json data = json::parse(report::plot_json(small_plot()));
  const json& first = data["series"][0];
  EXPECT_EQ(first["x"], (std::vector<double>{1.0 / 3.0, 3.0}));
  EXPECT_EQ(first["y"], (std::vector<double>{0.1, 1e-300})) << "-1 has no logarithm";
  EXPECT_EQ(first["notes"], (std::vector<std::string>{"a", "c"})) << "they stay beside their points";
  EXPECT_EQ(first["hollow"], (std::vector<bool>{true, false}));
  EXPECT_EQ(first["mark"], "line-points");
  EXPECT_EQ(first["group"], "family");
  EXPECT_EQ(data["series"][1]["colour"], "ink");
  EXPECT_EQ(data["levels"][0]["y"], 0.5);
  EXPECT_EQ(data["floor_y"], 1e-6);
  EXPECT_EQ(data["log_x"], false);
  EXPECT_EQ(data["log_y"], true);
}

TEST(PlotJson, WritesAFloorThatIsNotThereAsNull) {
  Plot plot = small_plot();
  plot.floor_y = std::nan("");
  EXPECT_TRUE(json::parse(report::plot_json(plot))["floor_y"].is_null());
}

TEST(PlotJson, KeepsThePeakOfACurveThatIsThinned) {
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

TEST(PlotJson, RefusesAPlotOfNothing) { EXPECT_THROW(report::plot_json(Plot{}), Error); }
