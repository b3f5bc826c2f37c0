#include "report/trace.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "report/run_report.h"
#include "temporary_folder.h"
#include "well_formed.h"

using namespace palpate;

namespace {

const char* const kText =
    "time_s,step_s,order,error,newton_iterations,outcome,worst_body,worst_node,worst_axis,inverted_body,"
    "inverted_element\n"
    "0,0.004,3,7.5,2,error "
    "test,liver,2,y,,\n0,0.001,3,0.5,2,accepted,liver,0,x,,\n0.001,0.002,3,nan,9,Newton,,,,liver,12\n0.001,0."
    "001,3,0.4,2,accepted,liver,0,x,,\n";

TEST(StepPlot, ShowsAcceptedStepsAsALineAndRejectedOnesByReason) {
  report::Table table;
  table.headers = {"time_s", "step_s", "outcome"};
  table.rows = {{"0", "0.004", "error test"},
                {"0", "0.001", "accepted"},
                {"0.001", "0.002", "Newton"},
                {"0.001", "0.001", "accepted"}};
  const report::Plot plot = report::step_plot(table);
  ASSERT_EQ(plot.series.size(), 3u);
  EXPECT_EQ(plot.series[0].name, "accepted");
  EXPECT_EQ(plot.series[0].x, (std::vector<double>{0, 0.001}));
  EXPECT_EQ(plot.series[1].name, "error test");
  EXPECT_EQ(plot.series[1].y, (std::vector<double>{0.004}));
  EXPECT_NE(plot.series[1].colour, plot.series[2].colour);
  EXPECT_TRUE(plot.log_y);
}

TEST(RunReport, ShowsATrace) {
  const TemporaryFolder dir;
  dir.write("trace.csv", kText);
  report::write_run_report(dir.path());
  std::ifstream in(dir / "report.html", std::ios::binary);
  const std::string html{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(well_formed_problem(html), "");
  for (const char* text :
       {"causes of rejection", "liver, node 2, y", "liver, node 0, x", "inverted element", "plot-data"})
    EXPECT_NE(html.find(text), std::string::npos) << text;
}

}  // namespace
