#include "report/plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "palpate/core/error.h"
#include "report/force_plot.h"
#include "report/page.h"
#include "report/thin.h"
#include "temporary_folder.h"
#include "well_formed.h"

using namespace palpate;

namespace {

report::Plot small_plot() {
  report::Plot plot;
  plot.title = "A title";
  plot.x_label = "time [s]";
  plot.y_label = "force_x [N]";
  plot.series.push_back({.name = "first_series <a&b>",
                         .x = {0, 1, 2},
                         .y = {0, 1, 4},
                         .mark = report::Mark::kLinePoints,
                         .labels = {"p0", "p\"1", "p2"}});
  plot.series.push_back(
      {.name = "second", .x = {0, 2}, .y = {4, 0}, .mark = report::Mark::kDashed, .colour = "ink"});
  plot.levels.push_back({3.0, "limit 3 N"});
  return plot;
}

std::string message_of(const report::Plot& plot) {
  try {
    report::plot_svg(plot);
  } catch (const Error& e) { return e.what(); }
  return "no error";
}

/// Sets an environment variable and restores it at the end of the scope.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const char* value) : name_(name), old_(std::getenv(name)) {
    setenv(name, value, 1);
  }
  ~ScopedVariable() { setenv(name_, old_.c_str(), 1); }

 private:
  const char* name_;
  std::string old_;
};

}  // namespace

TEST(Plot, ShowsNamesLabelsAndLevels) {
  const std::string svg = report::plot_svg(small_plot());
  for (const char* text : {"A title", "time [s]", "force_x [N]", "first_series &lt;a&amp;b>", "second",
                           ">p0<", "p2", "limit 3 N"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  EXPECT_EQ(well_formed_problem(svg.substr(svg.find("<svg"))), "");
}

TEST(Plot, RunsNoCommandHiddenInAName) {
  const TemporaryFolder folder;
  const auto trace = folder / "must_not_exist";
  report::Plot plot = small_plot();
  const std::string command = "`touch " + trace.string() + "` '; system 'touch " + trace.string() + "'";
  plot.title = plot.x_label = plot.series[0].name = plot.series[0].labels[0] = plot.levels[0].label = command;
  report::plot_svg(plot);
  EXPECT_FALSE(std::filesystem::exists(trace));
}

TEST(Plot, LeavesNoBlackInAPage) {
  // A curve in the text colour must follow the page's text into dark mode.
  const std::string html = report::Page("t").add_svg(report::plot_svg(small_plot()), "").html();
  const std::string svg = html.substr(html.find("<svg"));
  for (const char* black : {"black", "rgb(  0,   0,   0)", "rgb(0,0,0)"})
    EXPECT_EQ(svg.find(black), std::string::npos) << black;
}

TEST(Plot, IsTheSameTwice) { EXPECT_EQ(report::plot_svg(small_plot()), report::plot_svg(small_plot())); }

TEST(Plot, LeavesOutWhatAnAxisCannotShow) {
  report::Plot plot = small_plot();
  plot.log_x = plot.log_y = true;
  // (0, 0) does not exist on logarithmic axes
  EXPECT_EQ(report::plot_svg(plot).find(">p0<"), std::string::npos);
}

TEST(Plot, SaysWhenThereIsNothingToDraw) {
  report::Plot plot = small_plot();
  for (auto& s : plot.series) std::fill(s.y.begin(), s.y.end(), std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(message_of(plot), "plot \"A title\": there is nothing to draw: no point is finite");
}

TEST(Plot, RefusesSeriesOfUnequalLengths) {
  report::Plot plot = small_plot();
  plot.series[0].y.pop_back();
  EXPECT_THROW(report::plot_svg(plot), InternalError);
}

TEST(Plot, NamesThePackageWhenGnuplotIsMissing) {
  const ScopedVariable path("PATH", "/nowhere");
  EXPECT_NE(message_of(small_plot()).find("install the package gnuplot-nox"), std::string::npos);
}

TEST(Plot, PassesOnWhatGnuplotComplainsAbout) {
  report::Plot plot = small_plot();
  plot.series[0].colour = "no-such-colour";
  const std::string message = message_of(plot);
  EXPECT_NE(message.find("gnuplot drew no plot"), std::string::npos) << message;
  EXPECT_NE(message.find("color"), std::string::npos) << message;
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
