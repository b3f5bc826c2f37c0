// Comparisons that are incomplete: runs and references that fail, run out of time or are stopped, and what a
// comparison takes from its results.db when it resumes.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>

#include "experiments/compare/scenes.h"
#include "palpate/experiments/compare.h"
#include "store/csv.h"
#include "store/study_columns.h"
#include "temporary_folder.h"

using namespace palpate;
using compare::Status;
using compare_scenes::quick;

namespace {

// A run that fails after a hundredth of the duration is close to the reference until then: no error is
// reported for it.
TEST(Compare, ARunThatFailsIsARowWithItsReasonAndNoError) {
  const std::string text =
      "[integrator]\nmax_steps = 2000\n[[compare.ladder]]\nintegrator = \"linearly-implicit-euler\"\nstep_s "
      "= [1e-3, 1e-6]\n";
  compare::CompareOptions options = quick();
  options.integrators = {"linearly-implicit-euler"};
  const compare::Comparison all = compare::run({compare_scenes::block(text)}, options);
  const compare::SceneComparison& c = all.scenes[0];
  ASSERT_EQ(c.points.size(), 2u);
  EXPECT_EQ(c.points[0].status, Status::kOk);
  EXPECT_EQ(c.points[1].status, Status::kFailed);
  EXPECT_NE(c.points[1].reason.find("reached max_steps"), std::string::npos) << c.points[1].reason;
  const compare::TrajectoryError& e = c.points[1].error;
  for (const double value :
       {e.position_rel_l2, e.position_max_m, e.force_rms_n, e.torque_rms_n_m, e.energy_j})
    EXPECT_TRUE(std::isnan(value));
  EXPECT_FALSE(c.points[1].unresolved || c.points[1].force_unresolved || c.points[1].torque_unresolved);

  const TemporaryFolder folder;
  compare::write(all, folder.string());
  const store::CsvTable table = store::read_csv((folder / "compare.csv").string());
  ASSERT_EQ(table.rows.size(), 2u);
  const std::vector<std::string>& known = store::compare_columns();
  ASSERT_GT(table.headers.size(), known.size()) << "what reports know, then every further number of a run";
  EXPECT_TRUE(std::equal(known.begin(), known.end(), table.headers.begin()));
  EXPECT_EQ(table.column("status")[1], "failed");
  EXPECT_EQ(table.column("reason")[1], c.points[1].reason);
  EXPECT_TRUE(std::filesystem::exists(folder / "reference.json"));
  EXPECT_FALSE(std::filesystem::exists(folder / "exchange.csv")) << "no tool, no exchange";
}

TEST(Compare, ALadderEndsWhereItRunsOutOfTime) {
  const std::string text =
      "[[compare.ladder]]\nintegrator = \"linearly-implicit-euler\"\nstep_s = [1e-3, 1e-7, 1e-8]\n";
  compare::CompareOptions options = quick();
  options.integrators = {"linearly-implicit-euler"};
  options.limit_s = 0.3;
  const auto d =
      loop::parse(compare_scenes::block_text("[integrator]\nmax_steps = 1000000000\n" + text), "block.toml");
  const compare::SceneComparison c = compare::run({d}, options).scenes[0];
  ASSERT_EQ(c.points.size(), 3u);
  EXPECT_EQ(c.points[0].status, Status::kOk);
  EXPECT_EQ(c.points[1].status, Status::kOutOfTime);
  EXPECT_NE(c.points[1].reason.find("out of time: 0.3 s"), std::string::npos) << c.points[1].reason;
  EXPECT_EQ(c.points[2].status, Status::kNotTried);
  EXPECT_EQ(c.points[2].reason, "not tried: a coarser level ran out of time");
}

TEST(Compare, WhatCannotRunTheSceneSaysSoOnce) {
  const std::string text =
      "[[compare.ladder]]\nintegrator = \"cvode-bdf\"\nset = [\"body.0.mesh.element_size_m=1e-6\"]\nrtol = "
      "[1e-2, 1e-3]\n";
  compare::CompareOptions options = quick();
  options.integrators = {"cvode-bdf"};
  const compare::SceneComparison c = compare::run({compare_scenes::block(text)}, options).scenes[0];
  ASSERT_EQ(c.points.size(), 1u);
  EXPECT_EQ(c.points[0].status, Status::kRefused);
  EXPECT_NE(c.points[0].reason.find("element_size_m = 1e-06 gives about"), std::string::npos)
      << c.points[0].reason;
}

// The explicit check exceeds its step limit on a stiff block; cvode-bdf does not.
TEST(Compare, WithoutACheckTheReferencesOwnErrorIsNotKnown) {
  const std::string text =
      "[integrator]\nmax_steps = 400\n[[compare.ladder]]\nintegrator = \"cvode-bdf\"\nrtol = "
      "[1e-3]\n[compare]\nreference_rtol = 1e-6\n";
  compare::CompareOptions options = quick();
  options.integrators = {"cvode-bdf"};
  const compare::SceneComparison c =
      compare::run({compare_scenes::block(text, "stiff", 1e8)}, options).scenes[0];
  EXPECT_TRUE(c.reference.available);
  EXPECT_TRUE(std::isnan(c.reference.own_error.position_rel_l2));
  EXPECT_NE(c.reference.trouble.find("the check by ark-erk-5"), std::string::npos) << c.reference.trouble;
  ASSERT_EQ(c.points.size(), 1u);
  EXPECT_EQ(c.points[0].status, Status::kOk) << c.points[0].reason;
  EXPECT_TRUE(c.points[0].error.position_rel_l2 > 0.0);
  EXPECT_FALSE(c.points[0].unresolved);
}

TEST(Compare, WithoutAReferencePointsHaveCostsAndNoErrors) {
  const std::string text =
      "[[compare.ladder]]\nintegrator = \"linearly-implicit-euler\"\nstep_s = "
      "[1e-3]\n[compare]\nreference_rtol = 1e-10\nreference_check_rtol = 1e-12\n";
  compare::CompareOptions options = quick();
  options.integrators = {"linearly-implicit-euler"};
  options.reference_limit_s = 1e-6;  // shorter than any run
  const compare::SceneComparison c = compare::run({compare_scenes::block(text)}, options).scenes[0];
  EXPECT_FALSE(c.reference.available);
  EXPECT_NE(c.reference.trouble.find("there is no reference"), std::string::npos) << c.reference.trouble;
  ASSERT_EQ(c.points.size(), 1u);
  EXPECT_EQ(c.points[0].status, Status::kOk);
  EXPECT_TRUE(std::isnan(c.points[0].error.position_rel_l2));
  EXPECT_GT(c.points[0].result.counters.steps, 0);
}

TEST(Compare, StopsAtOnceWhenAsked) {
  std::atomic<bool> stop{true};
  compare::CompareOptions options = quick();
  options.stop = &stop;
  const compare::Comparison all = compare::run({compare_scenes::block(compare_scenes::kLadders)}, options);
  EXPECT_TRUE(all.stopped);
  for (const compare::ComparePoint& p : all.scenes[0].points) EXPECT_EQ(p.status, Status::kMissing);
}

TEST(Compare, GoesOnFromItsDatabaseAndDoesNothingTwice) {
  const TemporaryFolder folder;
  compare::CompareOptions options = quick();
  options.repeats = 2;
  options.folder = folder.string();
  const auto d = compare_scenes::block(compare_scenes::kLadders);
  const compare::Comparison first = compare::run({d}, options);
  EXPECT_EQ(first.reused, 0);
  int runs = 0;
  options.progress = [&](double, const std::string&) { ++runs; };
  const compare::Comparison again = compare::run({d}, options);
  EXPECT_EQ(runs, 0);
  EXPECT_EQ(again.reused, 2 + 2 * 6);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(again.scenes[0].points[i].cpu_s, first.scenes[0].points[i].cpu_s);
    EXPECT_EQ(again.scenes[0].points[i].error.energy_j, first.scenes[0].points[i].error.energy_j);
  }
  // Another refinement level changes no other run; another scene changes all runs.
  const auto longer = compare_scenes::block(
      compare_scenes::kLadders +
      "[[compare.ladder]]\nintegrator = \"cvode-bdf\"\nlabel = \"more\"\nrtol = [1e-5]\n");
  options.integrators.push_back("more");
  compare::run({longer}, options);
  EXPECT_EQ(runs, 2);
  options.integrators.pop_back();
  compare::run({compare_scenes::block(compare_scenes::kLadders, "block", 1.1e4)}, options);
  EXPECT_EQ(runs, 2 + 2 + 2 * 6);
}

// A point that exceeded its time limit is run again only under a larger limit.
TEST(Compare, MoreTimeTriesAgain) {
  const TemporaryFolder folder;
  compare::CompareOptions options = quick();
  options.integrators = {"linearly-implicit-euler"};
  options.folder = folder.string();
  options.limit_s = 0.02;
  const auto d = compare_scenes::block(
      "[[compare.ladder]]\nintegrator = \"linearly-implicit-euler\"\nstep_s = [1e-5]\n");
  EXPECT_EQ(compare::run({d}, options).scenes[0].points[0].status, Status::kOutOfTime);
  EXPECT_EQ(compare::run({d}, options).reused, 3);
  options.limit_s = 60.0;
  EXPECT_EQ(compare::run({d}, options).scenes[0].points[0].status, Status::kOk);
}

#ifdef PALPATE_HAS_TOOL
// A chart that a limit cut off is no chart of fewer points.  It is made again under a larger limit.
TEST(Compare, AChartThatRanOutOfTimeIsMadeAgainWithMoreTime) {
  const TemporaryFolder folder;
  compare::CompareOptions options = quick();
  options.integrators = {"linearly-implicit-euler"};
  options.folder = folder.string();
  options.reference_limit_s = 1e-6;  // shorter than any run
  const auto d = loop::parse(compare_scenes::touch_text("0.034", "", "", R"([exchange]
exchange_period_s = 0.01
[compare]
duration_s = 0.01
exchange_periods_s = [0.01, 0.005]
contact_methods = ["analytic", "distance"]
[[compare.ladder]]
integrator = "linearly-implicit-euler"
step_s = [0.01]
)"),
                             "touch.toml");
  const compare::SceneComparison cut = compare::run({d}, options).scenes[0];
  ASSERT_EQ(cut.missing_charts.size(), 2u);
  EXPECT_EQ(cut.missing_charts[0].of, "the contact methods");
  // a point may end before its time is looked at
  const std::string& why = cut.missing_charts[0].why;
  EXPECT_TRUE(why == "out of time: 1e-06 s (after 0 of 2 points)" ||
              why == "out of time: 1e-06 s (after 1 of 2 points)")
      << why;
  EXPECT_EQ(cut.missing_charts[1].of, "the exchange period");
  EXPECT_EQ(compare::run({d}, options).scenes[0].missing_charts.size(), 2u) << "it is not tried in vain";
  options.reference_limit_s = 300.0;
  const compare::SceneComparison whole = compare::run({d}, options).scenes[0];
  for (const compare::MissingChart& chart : whole.missing_charts) ADD_FAILURE() << chart.text();
  EXPECT_EQ(whole.methods.size(), 2u);
  EXPECT_EQ(whole.exchange.points.size(), 2u);
}
#endif

}  // namespace
