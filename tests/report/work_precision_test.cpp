#include "palpate/report/work_precision.h"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/core/error.h"

using namespace palpate;

namespace {

/// A table with the columns of compare.csv; `fast` is of order 1 at 1/h seconds, `good` of order 2 at 3/h seconds.
report::Table compare_table() {
  report::Table table;
  table.headers = report::compare_columns();
  const auto add = [&](const char* name, double h, double error, double cpu, const char* status, bool below) {
    std::vector<std::string> row(table.headers.size(), "");
    row[table.column("integrator")] = name;
    row[table.column("setting_name")] = "step_s";
    row[table.column("setting")] = fmt::format("{}", h);
    row[table.column("position_error_rel_l2")] = fmt::format("{}", error);
    row[table.column("cpu_s_median")] = fmt::format("{}", cpu);
    row[table.column("status")] = status;
    row[table.column("below_reference")] = below ? "true" : "false";
    table.rows.push_back(row);
  };
  for (const double h : {0.1, 0.05, 0.025, 0.0125}) {
    add("fast", h, 0.5 * h, 1.0 / h, "ok", false);
    add("good", h, 2.0 * h * h, 3.0 / h, "ok", false);
  }
  add("fast", 0.4, 1e-9, 0.001, "diverged", false);  // cheap and wrong: must count nowhere
  add("good", 0.001, 0.1, 5000.0, "ok", true);       // below the reference: not in the fit
  return table;
}

}  // namespace

// Positions below their reference say nothing about the force, and the other way round.
TEST(WorkPrecision, AForceIsHeldAgainstItsOwnReference) {
  report::Table table = compare_table();
  for (auto& row : table.rows) {
    row[table.column("force_error_rms_n")] = row[table.column("position_error_rel_l2")];
    row[table.column("force_below_reference")] = row[table.column("setting")] == "0.0125" ? "yes" : "no";
  }
  const auto orders = report::fitted_orders(table, "force_error_rms_n");
  EXPECT_EQ(orders[0].points, 3);  // of fast: 0.1, 0.05, 0.025
  EXPECT_EQ(orders[1].points, 4);  // of good: those and 0.001, whose position alone is below
}

TEST(FittedOrders, AreTheSlopesOfPowerLaws) {
  const auto orders = report::fitted_orders(compare_table(), "position_error_rel_l2");
  ASSERT_EQ(orders.size(), 2u);
  EXPECT_EQ(orders[0].integrator, "fast");
  EXPECT_NEAR(orders[0].order, 1.0, 1e-12);
  EXPECT_NEAR(orders[1].order, 2.0, 1e-12);
  EXPECT_EQ(orders[0].points, 4);
  EXPECT_EQ(orders[1].points, 4);
}

TEST(FittedOrders, OnePointHasNone) {
  report::Table table = compare_table();
  table.rows.resize(1);
  const auto orders = report::fitted_orders(table, "position_error_rel_l2");
  ASSERT_EQ(orders.size(), 1u);
  EXPECT_TRUE(std::isnan(orders[0].order));
}

TEST(Cheapest, IsTheLeastCpuTimeThatReachesTheError) {
  // errors of `fast`: 0.05 0.025 0.0125 0.00625 at 10 20 40 80 s; of `good`: 0.02 0.005 0.00125 0.0003125 at 30 60 120 240 s
  const auto best = report::cheapest(compare_table(), "position_error_rel_l2", {0.05, 0.01, 0.001, 1e-4});
  ASSERT_EQ(best.size(), 4u);
  EXPECT_EQ(best[0].integrator, "fast");
  EXPECT_DOUBLE_EQ(best[0].cpu_s, 10.0);
  EXPECT_EQ(best[1].integrator, "good");
  EXPECT_DOUBLE_EQ(best[1].cpu_s, 60.0);
  EXPECT_EQ(best[2].integrator, "good");
  EXPECT_DOUBLE_EQ(best[2].cpu_s, 240.0);
  EXPECT_FALSE(best[3].found);
}

TEST(WorkPrecisionPlot, HasOneLineAnIntegratorWithoutFailedPoints) {
  const report::Plot plot = report::work_precision_plot(compare_table(), "position_error_rel_l2", "error", 1e-4);
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_EQ(plot.series[0].x.size(), 4u);
  EXPECT_EQ(plot.series[1].labels[0], "100 ms");
  EXPECT_TRUE(plot.series[1].hollow.back());
  const std::string svg = report::plot_svg(plot);
  for (const char* text : {"fast", "good", "100 ms", "the reference's own error"}) EXPECT_NE(svg.find(text), std::string::npos) << text;
}

TEST(ExchangePlot, DrawsTheFittedOrder) {
  report::Table table;
  table.headers = report::exchange_columns();
  for (const double h : {0.02, 0.01, 0.005}) table.rows.push_back({fmt::format("{}", h), fmt::format("{}", 3.0 * h * h), "", "", "1"});
  const report::Plot plot = report::exchange_plot(table, "position_error_rel_l2", "error");
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_EQ(plot.series[1].name, "fitted order 2.00");
  EXPECT_NEAR(plot.series[1].y[0], 3.0 * 0.005 * 0.005, 1e-15);
}

TEST(SettingText, IsShort) {
  EXPECT_EQ(report::setting_text("rtol", 1e-4), "1e-4");
  EXPECT_EQ(report::setting_text("rtol", 2.5e-4), "0.00025");
  EXPECT_EQ(report::setting_text("step_s", 0.002), "2 ms");
  EXPECT_EQ(report::setting_text("step_s", 0.0005), "500 us");
}

TEST(WorkPrecision, NamesAMissingColumn) {
  report::Table table;
  table.headers = {"integrator"};
  table.source = "compare.csv";
  EXPECT_THROW(report::fitted_orders(table, "position_error_rel_l2"), Error);
}
