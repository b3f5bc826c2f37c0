#include "report/work_precision.h"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/core/error.h"
#include "report/comparison_words.h"
#include "report/cost_envelope.h"
#include "report/work_precision_plots.h"
#include "store/study_columns.h"

using namespace palpate;

namespace {

/// Slowest repeat over the median, and the median over the fastest.
constexpr double kNoise = 1.05;
/// Reference error: far below every point.
constexpr double kExact = 1e-9;

/// Sets the cells of a column of one refinement sequence, from the coarsest level to the finest.
void put(report::Table& table, const std::string& label, const char* column, std::vector<double> values) {
  std::size_t next = 0;
  for (auto& row : table.rows)
    if (row[table.column("label")] == label && next < values.size())
      row[table.column(column)] = fmt::format("{}", values[next++]);
}

/// A table with the columns of compare.csv; `fast` has order 1 at 1/h seconds, `good` order 2 at 3/h seconds.
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
    row[table.column("cpu_s_min")] = fmt::format("{}", cpu / kNoise);
    row[table.column("cpu_s_max")] = fmt::format("{}", cpu * kNoise);
    row[table.column("repeats")] = "3";
    row[table.column("coarsest")] = "yes";
    row[table.column("status")] = status;
    row[table.column("unresolved")] = below ? "true" : "false";
    table.rows.push_back(row);
  };
  for (const double h : {0.1, 0.05, 0.025, 0.0125}) {
    add("fast", h, 0.5 * h, 1.0 / h, "ok", false);
    add("good", h, 2.0 * h * h, 3.0 / h, "ok", false);
  }
  add("fast", 0.4, 1e-9, 0.001, "diverged", false);  // fast but diverged: must not count
  add("good", 0.001, 9e-6, 5000.0, "ok", true);      // below the reference error: not in the fit
  return table;
}

}  // namespace

// Positions below their reference error imply nothing about the force, and vice versa.
TEST(WorkPrecision, AForceIsHeldAgainstItsOwnReference) {
  report::Table table = compare_table();
  for (auto& row : table.rows) {
    row[table.column("force_error_rms_n")] = row[table.column("position_error_rel_l2")];
    row[table.column("force_unresolved")] = row[table.column("setting")] == "0.0125" ? "yes" : "no";
  }
  const auto orders = report::fitted_orders(table, "force_error_rms_n");
  EXPECT_EQ(orders[0].points, 3);  // fast: 0.1, 0.05, 0.025
  EXPECT_EQ(orders[1].points, 4);  // good: those and 0.001, whose position alone is below
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
// 0.005 0.00125 0.0003125 at 30 60 120 240 s, so that error x cost^2 = 18. Both are straight in log-log:
// interpolation is exact.
class CostAt : public testing::Test {
 protected:
  CostAt() { table_.rows.pop_back(); }
  report::Cost at(const std::string& label, double target, double reference_error = kExact) const {
    for (const report::Ladder& ladder : report::ladders(table_, "position_error_rel_l2", "cpu_s_median"))
      if (ladder.label == label) return report::cost_at(ladder, target, reference_error);
    return {};
  }
  report::Table table_ = compare_table();
};

TEST_F(CostAt, IsExactOnPowerLawsAndHoldsTheSpreadOfRepeats) {
  for (const double target : {0.03, 0.01, 0.00625}) {
    const report::Cost cost = at("fast", target);
    EXPECT_NEAR(cost.value, 0.5 / target, 1e-9);
    EXPECT_NEAR(cost.low, cost.value / kNoise, 1e-9);
    EXPECT_NEAR(cost.high, cost.value * kNoise, 1e-9);
  }
  EXPECT_NEAR(at("good", 0.001).value, std::sqrt(18.0 / 0.001), 1e-9);
  EXPECT_FALSE(at("good", 0.001).at_most);
}

TEST_F(CostAt, ExtrapolatesNothing) {
  EXPECT_TRUE(std::isnan(at("fast", 0.006).value)) << "finer than its finest rung";
  const report::Cost coarse = at("good", 0.5);
  EXPECT_DOUBLE_EQ(coarse.value, 30.0);
  EXPECT_TRUE(coarse.at_most) << "coarser than its coarsest rung";
  EXPECT_NEAR(coarse.low, 30.0 / kNoise, 1e-9) << "no coarser one makes sense";
  EXPECT_EQ(report::cost_text(coarse), "<= 30");
  for (auto& row : table_.rows) row[table_.column("coarsest")] = "no";
  EXPECT_EQ(at("good", 0.5).low, 0.0) << "a coarser rung that was not tried may cost anything";
}

// A level whose error passes through zero: its finer neighbours show the method's actual accuracy. The
// cheapest crossing alone would give 1e-3 at 20 s.
TEST_F(CostAt, OneLuckyRungDoesNotWin) {
  put(table_, "fast", "position_error_rel_l2", {0.05, 1e-4, 0.0125, 0.00625});
  EXPECT_TRUE(std::isnan(at("fast", 1e-3).value) || at("fast", 1e-3).value > 40.0);
  EXPECT_FALSE(at("fast", 1e-3).high < std::numeric_limits<double>::infinity())
      << "no finer rung confirms it";
  const report::Cost cost = at("fast", 0.01);
  EXPECT_LT(cost.low, 20.0) << "what the lucky rung may mean is within the spread";
  EXPECT_GT(cost.high, 0.5 / 0.01) << "and so is that it means nothing";
  EXPECT_GE(cost.value, cost.low);
  EXPECT_LE(cost.value, cost.high);
}

TEST_F(CostAt, AFinerRungThatIsCheaperIsTakenInstead) {
  put(table_, "fast", "cpu_s_median", {10, 50, 40, 80});
  EXPECT_DOUBLE_EQ(at("fast", 0.025).value, 40.0);
}

TEST_F(CostAt, NothingIsInterpolatedAcrossARungThatFailed) {
  const double across = at("fast", 0.0135).value;
  EXPECT_GT(across, 20.0);
  EXPECT_LT(across, 40.0);
  put(table_, "fast", "position_error_rel_l2", {0.05, std::nan("")});
  for (auto& row : table_.rows)
    if (row[table_.column("label")] == "fast" && row[table_.column("setting")] == "0.05")
      row[table_.column("status")] = "failed";
  const report::Cost behind = at("fast", 0.0135);
  EXPECT_DOUBLE_EQ(behind.value, 40.0);
  EXPECT_TRUE(behind.at_most);
  EXPECT_NEAR(behind.low, 40.0 / kNoise / 2.0, 1e-9) << "the limit of its step lies somewhere between";
}

// Errors within ten times the reference error are uncertain by that amount; below it, nothing has a cost.
TEST_F(CostAt, TrustsNoErrorThatTheReferenceCannotTell) {
  EXPECT_TRUE(std::isnan(at("good", 0.0005, 1e-4).value));
  EXPECT_TRUE(std::isnan(at("fast", 0.01, report::kUnknown).value)) << "of an unknown error nothing is known";
  // from 0.00125 at 120 s to at most 0.001 at 240 s
  const double cost = at("good", 0.00115, 1e-4).value;
  EXPECT_NEAR(cost, 120.0 * std::pow(2.0, std::log(0.00125 / 0.00115) / std::log(0.00125 / 0.001)), 1e-9);
}

// A level that ran once has the uncertainty of its neighbours.
TEST_F(CostAt, WithoutRepeatsTheSpreadIsThatOfTheOthers) {
  for (auto& row : table_.rows)
    if (row[table_.column("label")] == "fast") {
      row[table_.column("repeats")] = "1";
      row[table_.column("cpu_s_min")] = row[table_.column("cpu_s_max")] = row[table_.column("cpu_s_median")];
    }
  EXPECT_NEAR(at("fast", 0.025).high, 20.0 * kNoise, 1e-9);
  for (auto& row : table_.rows) row[table_.column("repeats")] = "1";
  EXPECT_TRUE(std::isnan(at("fast", 0.025).high)) << "none ran again";
  EXPECT_DOUBLE_EQ(at("fast", 0.025).value, 20.0);
}

TEST(Winners, AreTheCheapestWithTheirLead) {
  report::Table table = compare_table();
  table.rows.pop_back();
  const auto wins = report::winners(table, "position_error_rel_l2", "cpu_s_median",
                                    {0.05, 0.01, 0.001, 1e-4, 1e-9}, kExact);
  ASSERT_EQ(wins.size(), 5u);
  EXPECT_EQ(wins[0].label, "fast");
  EXPECT_DOUBLE_EQ(wins[0].cost.value, 10.0);
  EXPECT_EQ(wins[0].runner_up, "good");
  EXPECT_TRUE(wins[0].declared());
  EXPECT_DOUBLE_EQ(wins[0].runner_up_ratio.value, 3.0);
  EXPECT_NEAR(wins[0].runner_up_ratio.low, 3.0 / kNoise / kNoise, 1e-9);
  EXPECT_NEAR(wins[0].runner_up_ratio.high, 3.0 * kNoise * kNoise, 1e-9);
  EXPECT_EQ(wins[1].label, "good");
  EXPECT_NEAR(wins[1].cost.value, std::sqrt(1800.0), 1e-9);
  EXPECT_NEAR(wins[1].runner_up_ratio.value, 50.0 / std::sqrt(1800.0), 1e-9);
  EXPECT_EQ(wins[2].label, "good");
  EXPECT_TRUE(wins[2].runner_up.empty());
  EXPECT_TRUE(wins[3].resolved);
  EXPECT_FALSE(wins[3].found);
  EXPECT_FALSE(wins[4].resolved) << "the reference cannot tell such errors";
}

TEST(Winners, AreNotDeclaredWithinTheSpread) {
  report::Table table = compare_table();
  put(table, "good", "cpu_s_median", {10.4});  // at 0.02, where fast needs 25 s; at 0.05 10 s
  put(table, "good", "cpu_s_min", {9.9});
  put(table, "good", "cpu_s_max", {10.9});
  const auto wins = report::winners(table, "position_error_rel_l2", "cpu_s_median", {0.05, 0.02}, kExact);
  EXPECT_TRUE(wins[0].found);
  EXPECT_EQ(wins[0].rivals, std::vector<std::string>{"good"});
  EXPECT_FALSE(wins[0].declared());
  EXPECT_TRUE(wins[1].declared());
  EXPECT_NE(report::in_words(table, {.position_error_rel_l2 = kExact}).find("For an error of 0.01, good is"),
            std::string::npos);
  for (const auto& win :
       report::winners(table, "position_error_rel_l2", "cpu_s_median", {0.05, 0.02}, report::kUnknown))
    EXPECT_FALSE(win.found) << "nothing is declared against a reference whose error is unknown";
}

TEST(Winners, SayNothingOfASpreadThatIsNotKnown) {
  EXPECT_EQ(report::ratio_text({2.0, report::kUnknown, report::kUnknown}), "2.00");
  EXPECT_EQ(report::ratio_text({2.0, 1.5, report::kUnknown}), "2.00 (1.50 to ?)");
  EXPECT_EQ(report::spread_text({2.0, report::kUnknown, report::kUnknown}), "-");
  EXPECT_EQ(report::spread_text({2.0, 1.5, report::kUnknown}), "1.5 to ?");
}

TEST(Winners, TellHowMuchSlowerTheInteractiveMethodIs) {
  report::Table table = compare_table();
  for (auto& row : table.rows)
    if (row[table.column("label")] == "fast")
      row[table.column("label")] = row[table.column("integrator")] = report::kBaseline;
  const auto wins = report::winners(table, "position_error_rel_l2", "cpu_s_median", {0.01, 0.001}, kExact);
  EXPECT_NEAR(wins[0].baseline_ratio.value, 50.0 / std::sqrt(1800.0), 1e-9);
  EXPECT_LT(wins[0].baseline_ratio.low, wins[0].baseline_ratio.value);
  EXPECT_TRUE(std::isnan(wins[1].baseline_ratio.value)) << "it does not get there";
}

// Errors of the force are relative to its peak, and compared with the force's reference error.
TEST(InWords, NamesTheCheapestForTheForceOnTheHand) {
  report::Table table = compare_table();
  for (auto& row : table.rows) {
    const double position = report::to_number(row[table.column("position_error_rel_l2")]);
    row[table.column("force_error_rms_n")] = fmt::format("{}", 2.0 * position);
    row[table.column("force_unresolved")] = "no";
  }
  report::ReferenceError reference{.position_error_rel_l2 = kExact, .force_error_rms_n = kExact};
  EXPECT_EQ(report::in_words(table, reference).find("Error of the force on the hand"), std::string::npos)
      << "its peak is not known";
  reference.peak_force_n = 2.0;
  const std::string words = report::in_words(table, reference);
  EXPECT_NE(
      words.find("Error of the force on the hand relative to the peak of 2 N. For 0.01, good is the cheapest "
                 "(42.4 s)"),
      std::string::npos)
      << words;
}

TEST(InWords, SaysWhatTheNumbersSay) {
  report::Table table = compare_table();
  std::string words = report::in_words(table, {.position_error_rel_l2 = 1e-6});
  for (const char* part :
       {"For an error of 0.01, good is the cheapest (42.4 s); the next, fast, takes 1.18 (1.07 "
        "to 1.30) times as long",
        "For an error of 0.001, good is the cheapest (134 s).",
        "For an error of 0.0001, good is the cheapest (656 s).", "The reference does not resolve 1e-06",
        "Some levels of fast failed: diverged."})
    EXPECT_NE(words.find(part), std::string::npos) << part << " in: " << words;
  EXPECT_NE(words.find("all figures except those marked are resolved by the reference."), std::string::npos)
      << words;
  EXPECT_NE(words.find("1 point is within 10 times that error, is marked and not counted: errors below "
                       "1e-05 are not resolved."),
            std::string::npos)
      << words;
  table.rows.pop_back();
  words = report::in_words(table, {.position_error_rel_l2 = 2e-6});
  EXPECT_NE(words.find("No point reaches 0.0001"), std::string::npos) << words;
  EXPECT_NE(words.find("The reference error is 2e-06, 156 times below the best point that it resolves "
                       "(0.000313): all figures are resolved by the reference."),
            std::string::npos)
      << words;
  words = report::in_words(table, {.position_error_rel_l2 = 1e-4});
  EXPECT_NE(words.find("The reference error is 0.0001: errors below 0.001 are not resolved by it (the "
                       "best point has 0.000313)."),
            std::string::npos)
      << "only three times below: " << words;
  EXPECT_NE(report::in_words(table, {}).find("reference error is not known"), std::string::npos);
}

// A ten times tighter tolerance needs hardly more force evaluations: the stability limit, rather than the
// tolerance, determines the step.
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
  const std::string words = report::in_words(table, {.position_error_rel_l2 = 1e-9});
  EXPECT_NE(words.find("saves nothing: held."), std::string::npos) << words;
  EXPECT_NE(words.find("unstable at longer steps: fixed (usable at 1 ms and finer)."), std::string::npos)
      << words;
}

TEST(WorkPrecisionPlot, HasOneLineALadderWithoutFailedPoints) {
  const report::Plot plot =
      report::work_precision_plot(compare_table(), "position_error_rel_l2", "error", 1e-4);
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_EQ(plot.series[0].x.size(), 4u);
  EXPECT_EQ(plot.series[1].labels[0], "100 ms");
  EXPECT_TRUE(plot.series[1].hollow.back());
  const std::string json = report::plot_json(plot);
  for (const char* text : {"fast", "good", "100 ms", "reference error"})
    EXPECT_NE(json.find(text), std::string::npos) << text;
}

// Forty lines are distinguished by family; the non-dominated points are joined by one dark line, and named.
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
  // By increasing cost: fast at 10 and 20 s, good at 30 s (0.02 < 0.025), fast at 40 s (0.0125 < 0.02), good
  // at 60, 120 and 240 s.
  EXPECT_EQ(best.x, (std::vector<double>{10, 20, 30, 40, 60, 120, 240}));
  EXPECT_EQ(best.labels, (std::vector<std::string>{"fast", "", "good", "", "", "", ""}));
  const auto panels = report::family_plots(many, "position_error_rel_l2", "error", 1e-4);
  ASSERT_EQ(panels.size(), 2u);
  EXPECT_EQ(panels[0].title, "fast family");
  EXPECT_EQ(panels[0].series.size(), 8u);
  EXPECT_NE(report::plot_json(panels[0]).find("fast2"), std::string::npos);
  EXPECT_EQ(panels[0].series[0].colour, "faint") << "the other family, behind";
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
