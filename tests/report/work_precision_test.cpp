#include "palpate/report/work_precision.h"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/core/error.h"
#include "palpate/store/study_columns.h"

using namespace palpate;

namespace {

/// A table with the columns of compare.csv; `fast` is of order 1 at 1/h seconds, `good` of order 2 at 3/h
/// seconds.
report::Table compare_table() {
  report::Table table;
  table.headers = store::compare_columns();
  const auto add = [&](const char* name, double h, double error, double cpu, const char* status, bool below) {
    std::vector<std::string> row(table.headers.size(), "");
    row[table.column("scene")] = "s";
    row[table.column("label")] = row[table.column("integrator")] = name;
    row[table.column("family")] = std::string(name) + " family";
    row[table.column("setting_name")] = "step_s";
    row[table.column("setting")] = fmt::format("{}", h);
    row[table.column("position_error_rel_l2")] = fmt::format("{}", error);
    row[table.column("cpu_s_median")] = row[table.column("force_evaluations")] = fmt::format("{}", cpu);
    row[table.column("status")] = status;
    row[table.column("unresolved")] = below ? "true" : "false";
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
    row[table.column("force_unresolved")] = row[table.column("setting")] == "0.0125" ? "yes" : "no";
  }
  const auto orders = report::fitted_orders(table, "force_error_rms_n");
  EXPECT_EQ(orders[0].points, 3);  // of fast: 0.1, 0.05, 0.025
  EXPECT_EQ(orders[1].points, 4);  // of good: those and 0.001, whose position alone is below
}

TEST(FittedOrders, AreTheSlopesOfPowerLaws) {
  const auto orders = report::fitted_orders(compare_table(), "position_error_rel_l2");
  ASSERT_EQ(orders.size(), 2u);
  EXPECT_EQ(orders[0].label, "fast");
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

// Errors of `fast`: 0.05 0.025 0.0125 0.00625 at 10 20 40 80 s, so that error x cost = 0.5; of `good`: 0.02
// 0.005 0.00125 0.0003125 at 30 60 120 240 s, so that error x cost^2 = 18.  Both are straight in log-log:
// interpolation is exact.
TEST(CostAt, IsExactOnPowerLaws) {
  const auto all = report::ladders(compare_table(), "position_error_rel_l2", "cpu_s_median");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].failures.size(), 1u);
  for (const double target : {0.03, 0.01, 0.00625})
    EXPECT_NEAR(report::cost_at(all[0], target, report::kUnknown).value, 0.5 / target, 1e-9);
  EXPECT_NEAR(report::cost_at(all[1], 0.001, report::kUnknown).value, std::sqrt(18.0 / 0.001), 1e-9);
  EXPECT_FALSE(report::cost_at(all[1], 0.001, report::kUnknown).at_most);
}

TEST(CostAt, ExtrapolatesNothing) {
  const auto all = report::ladders(compare_table(), "position_error_rel_l2", "cpu_s_median");
  EXPECT_TRUE(std::isnan(report::cost_at(all[0], 0.006, report::kUnknown).value))
      << "finer than its finest rung";
  const report::Cost coarse = report::cost_at(all[1], 0.5, report::kUnknown);
  EXPECT_DOUBLE_EQ(coarse.value, 30.0);
  EXPECT_TRUE(coarse.at_most) << "coarser than its coarsest rung";
  EXPECT_EQ(report::cost_text(coarse), "<= 30");
}

// An error below the reference's own is known only to be below it: it counts as the reference's.
TEST(CostAt, TrustsNoErrorBelowTheReference) {
  const auto all = report::ladders(compare_table(), "position_error_rel_l2", "cpu_s_median");
  EXPECT_TRUE(std::isnan(report::cost_at(all[0], 0.007, 0.01).value));
  // from 0.025 at 20 s to 0.015 at 40 s
  const double cost = report::cost_at(all[0], 0.02, 0.0125 * 1.2).value;
  EXPECT_NEAR(cost, 20.0 * std::pow(2.0, std::log(0.025 / 0.02) / std::log(0.025 / 0.015)), 1e-9);
}

TEST(Winners, AreTheCheapestWithTheirLead) {
  const auto wins =
      report::winners(compare_table(), "position_error_rel_l2", "cpu_s_median", {0.05, 0.01, 0.001, 1e-4});
  ASSERT_EQ(wins.size(), 4u);
  EXPECT_EQ(wins[0].label, "fast");
  EXPECT_DOUBLE_EQ(wins[0].cost.value, 10.0);
  EXPECT_EQ(wins[0].runner_up, "good");
  EXPECT_DOUBLE_EQ(wins[0].runner_up_ratio, 3.0);
  EXPECT_EQ(wins[1].label, "good");
  EXPECT_NEAR(wins[1].cost.value, std::sqrt(1800.0), 1e-9);
  EXPECT_NEAR(wins[1].runner_up_ratio, 50.0 / std::sqrt(1800.0), 1e-9);
  EXPECT_EQ(wins[2].label, "good");
  EXPECT_TRUE(wins[2].runner_up.empty());
  EXPECT_FALSE(wins[3].found);
}

TEST(Winners, TellHowMuchSlowerTheInteractiveMethodIs) {
  report::Table table = compare_table();
  for (auto& row : table.rows)
    if (row[table.column("label")] == "fast")
      row[table.column("label")] = row[table.column("integrator")] = report::kBaseline;
  const auto wins = report::winners(table, "position_error_rel_l2", "cpu_s_median", {0.01, 0.001});
  EXPECT_NEAR(wins[0].baseline_ratio, 50.0 / std::sqrt(1800.0), 1e-9);
  EXPECT_TRUE(std::isnan(wins[1].baseline_ratio)) << "it does not get there";
}

TEST(InWords, SaysWhatTheNumbersSay) {
  report::Table table = compare_table();
  std::string words = report::in_words(table, 1e-6);
  for (const char* part :
       {"For an error of 0.01, good is the cheapest (42.4 s); the next, fast, takes 1.18 times as long",
        "For an error of 0.001, good is the cheapest (134 s).", "No point reaches 0.0001 and 1e-06",
        "Some rungs of fast failed: diverged."})
    EXPECT_NE(words.find(part), std::string::npos) << part << " in: " << words;
  EXPECT_NE(words.find("cannot be distinguished"), std::string::npos) << "one point lies below the reference";
  table.rows.pop_back();
  words = report::in_words(table, 2e-6);
  EXPECT_NE(words.find("The reference's own error, 2e-06, is 156 times below the best point that it can "
                       "judge, 0.000313: it bears every figure here."),
            std::string::npos)
      << words;
  EXPECT_NE(report::in_words(table, 1e-4).find("cannot be distinguished"), std::string::npos)
      << "only three times below";
  EXPECT_NE(report::in_words(table, report::kUnknown).find("own error is not known"), std::string::npos);
}

// Ten times tighter for hardly more force evaluations: the stability limit holds the step, not the tolerance.
TEST(InWords, NamesExplicitMethodsAtTheirStabilityLimit) {
  report::Table table;
  table.headers = store::compare_columns();
  const auto add = [&](const char* label, const char* stability, const char* setting, double value,
                       double error, double evaluations, const char* status) {
    std::vector<std::string> row(table.headers.size(), "");
    const auto put = [&](const char* column, const std::string& text) { row[table.column(column)] = text; };
    put("label", label), put("integrator", label), put("family", label), put("stability", stability),
        put("setting_name", setting), put("status", status);
    put("setting", fmt::format("{}", value)), put("position_error_rel_l2", fmt::format("{}", error)),
        put("reason", "not finite: at t = 1");
    put("cpu_s_median", fmt::format("{}", evaluations)),
        put("force_evaluations", fmt::format("{}", evaluations)), put("unresolved", "no");
    table.rows.push_back(row);
  };
  add("held", "explicit", "rtol", 1e-2, 1e-5, 1000, "ok");
  add("held", "explicit", "rtol", 1e-3, 1e-6, 1050, "ok");
  add("free", "explicit", "rtol", 1e-2, 1e-3, 1000, "ok");
  add("free", "explicit", "rtol", 1e-3, 1e-4, 1600, "ok");
  add("implicit", "L", "rtol", 1e-2, 1e-3, 1000, "ok");
  add("implicit", "L", "rtol", 1e-3, 1e-4, 1000, "ok");
  add("fixed", "explicit", "step_s", 2e-3, std::nan(""), 10, "failed");
  add("fixed", "explicit", "step_s", 1e-3, 1e-4, 2000, "ok");
  const std::string words = report::in_words(table, 1e-9);
  EXPECT_NE(words.find("saves nothing: held."), std::string::npos) << words;
  EXPECT_NE(words.find("unstable at longer steps: fixed (usable from 1 ms on)."), std::string::npos) << words;
}

TEST(WorkPrecisionPlot, HasOneLineALadderWithoutFailedPoints) {
  const report::Plot plot =
      report::work_precision_plot(compare_table(), "position_error_rel_l2", "error", 1e-4);
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_EQ(plot.series[0].x.size(), 4u);
  EXPECT_EQ(plot.series[1].labels[0], "100 ms");
  EXPECT_TRUE(plot.series[1].hollow.back());
  const std::string svg = report::plot_svg(plot);
  for (const char* text : {"fast", "good", "100 ms", "the reference's own error"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
}

// Forty lines are distinguished by family; what none beats is joined by one dark line, and named.
TEST(WorkPrecisionPlot, OfManyIsColouredByFamilyAndShowsTheEnvelope) {
  const report::Table two = compare_table();
  report::Table many = two;
  for (int copy = 0; copy < 3; ++copy)
    for (auto row : two.rows) {
      row[two.column("label")] += std::to_string(copy);
      row[two.column("cpu_s_median")] =
          fmt::format("{}", 2.0 * report::to_number(row[two.column("cpu_s_median")]));
      many.rows.push_back(row);
    }
  const report::Plot plot = report::work_precision_plot(many, "position_error_rel_l2", "error", 1e-4);
  ASSERT_EQ(plot.series.size(), 9u);
  int named = 0;
  for (const report::Series& s : plot.series) named += !s.name.empty();
  EXPECT_EQ(named, 3) << "two families and the envelope";
  EXPECT_EQ(plot.series[0].colour, plot.series[2].colour);
  const report::Series& best = plot.series.back();
  EXPECT_EQ(best.colour, "ink");
  // In the order of cost: fast at 10 and 20 s, good at 30 s (0.02 < 0.025), fast at 40 s (0.0125 < 0.02),
  // good at 60, 120 and 240 s.
  EXPECT_EQ(best.x, (std::vector<double>{10, 20, 30, 40, 60, 120, 240}));
  EXPECT_EQ(best.labels, (std::vector<std::string>{"fast", "", "good", "", "", "", ""}));
  const auto panels = report::family_plots(many, "position_error_rel_l2", "error", 1e-4);
  ASSERT_EQ(panels.size(), 2u);
  EXPECT_EQ(panels[0].title, "fast family");
  EXPECT_EQ(panels[0].series.size(), 8u);
  EXPECT_NE(report::plot_svg(panels[0]).find("fast2"), std::string::npos);
}

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
