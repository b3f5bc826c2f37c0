#include "report/work_precision_plots.h"

#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "store/study_columns.h"

using namespace palpate;

TEST(RestartPlot, ShowsRatesAgainstRefreshes) {
  report::Table table;
  table.headers = store::restart_columns();
  const auto add = [&](const char* label, const char* multistep, double refresh, double steps) {
    table.rows.push_back({"s", label, label, multistep, fmt::format("{}", refresh), "0.5", "3",
                          fmt::format("{}", steps), "9", "9", "1", "ok", ""});
  };
  add("bdf", "yes", 0.01, 100), add("bdf", "yes", 0.001, 400), add("euler", "no", 0.01, 50),
      add("euler", "no", 0.001, 50);
  const report::Plot plot = report::restart_plot(table, "steps", "steps per second");
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_EQ(plot.series[0].name, "bdf (multistep)");
  EXPECT_EQ(plot.series[0].x, (std::vector<double>{100, 1000}));
  EXPECT_EQ(plot.series[0].y, (std::vector<double>{200, 800}));
  EXPECT_EQ(plot.series[1].name, "euler (one-step)");
}

TEST(ExchangePlot, DrawsTheFittedOrder) {
  report::Table table;
  table.headers = report::exchange_columns();
  for (const double h : {0.02, 0.01, 0.005})
    table.rows.push_back({fmt::format("{}", h), fmt::format("{}", 3.0 * h * h), "", "", "1"});
  const report::Plot plot = report::exchange_plot(table, "position_error_rel_l2", "error");
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_EQ(plot.series[1].name, "fitted order 2.00");
  EXPECT_NEAR(plot.series[1].y[0], 3.0 * 0.005 * 0.005, 1e-15);
}
