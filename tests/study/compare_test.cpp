#include "palpate/study/compare.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/store/csv.h"
#include "palpate/study/bench.h"
#include "palpate/study/validation.h"

using namespace palpate;

namespace {

/// The block under its weight: smooth, no contact, so that orders are those of theory.
scene::Description swinging_block() {
  scene::Description d = small_scenes::held_block();
  d.gravity_m_s2 = Vec3(3, 0, -9.81);
  d.duration_s = 0.05;
  d.record.emplace();
  d.record->state_period_s = 0.01;
  d.compare.ladders.push_back({"linearly-implicit-euler", "step_s", {4e-4, 2e-4, 1e-4}});
  d.compare.ladders.push_back({"cvode-bdf", "rtol", {1e-2, 1e-4, 1e-6}});
  return d;
}

TEST(Compare, FindsTheOrderOfTheoryAgainstAReferenceOfAnotherFamily) {
  study::CompareOptions options;
  options.repeats = 2;
  int calls = 0;
  options.progress = [&](double fraction, const std::string& what) {
    ++calls;
    EXPECT_LE(fraction, 1.0);
    EXPECT_FALSE(what.empty());
  };
  const study::Comparison c = study::compare(swinging_block(), options);
  EXPECT_LT(c.reference.own_error.position_rel_l2, 1e-6);
  EXPECT_NE(c.reference.description.find("ark-erk-5"), std::string::npos);
  ASSERT_EQ(c.points.size(), 6u);
  EXPECT_EQ(calls, 2 + 2 * 6);
  std::vector<double> h, e;
  for (const study::ComparePoint& p : c.points) {
    EXPECT_EQ(p.cpu_s.size(), 2u);
    EXPECT_LE(p.cpu_min_s, p.cpu_median_s);
    EXPECT_TRUE(p.result.status.ok());
    if (p.integrator != "linearly-implicit-euler") continue;
    h.push_back(p.setting);
    e.push_back(p.error.position_rel_l2);
  }
  const double order = study::fitted_order(h, e);
  EXPECT_GT(order, 0.9);
  EXPECT_LT(order, 1.1);
  EXPECT_LT(c.points.back().error.position_rel_l2, 1e-4);
}

TEST(Compare, OneIntegratorOnly) {
  study::CompareOptions options;
  options.repeats = 1;
  options.integrators = {"cvode-bdf"};
  const study::Comparison c = study::compare(swinging_block(), options);
  EXPECT_EQ(c.points.size(), 3u);
}

TEST(Compare, NothingToCompareIsRefused) {
  scene::Description d = swinging_block();
  d.compare.ladders.clear();
  EXPECT_THROW(study::compare(d, {}), Error);
}

TEST(Compare, ARunThatFailsIsARowWithItsReason) {
  scene::Description d = swinging_block();
  d.compare.ladders = {{"linearly-implicit-euler", "step_s", {1e-3}}};
  d.integrator.max_steps = 100000;
  study::CompareOptions options;
  options.repeats = 1;
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("palpate-compare-test-" + std::to_string(getpid()));
  study::Comparison c = study::compare(d, options);
  c.points[0].result.status.status = dynamics::StepStatus::kNewtonFailed;
  c.points[0].result.status.message = "at t = 0.01, with \"quotes\", and a comma";
  study::write(c, folder.string());
  const store::CsvTable table = store::read_csv((folder / "compare.csv").string());
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_NE(table.column("status")[0].find("with \"quotes\", and a comma"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder / "reference.json"));
  EXPECT_FALSE(std::filesystem::exists(folder / "exchange.csv")) << "no tool, no exchange";
  std::filesystem::remove_all(folder);
}

// A run that gives up after a hundredth of the time is close to the truth for that long: no error is told for it.
TEST(Compare, ARunThatFailsHasNoErrorThatCouldCountAsGood) {
  scene::Description d = swinging_block();
  d.integrator.max_steps = 2000;  // in each period of 10 ms: enough for the references, not for the step below
  d.compare.ladders = {{"linearly-implicit-euler", "step_s", {1e-6}}};
  study::CompareOptions options;
  options.repeats = 1;
  const study::Comparison c = study::compare(d, options);
  ASSERT_FALSE(c.points[0].result.status.ok());
  const study::TrajectoryError& e = c.points[0].error;
  for (const double value : {e.position_rel_l2, e.position_max_m, e.force_rms_n, e.torque_rms_n_m, e.energy_j}) EXPECT_TRUE(std::isnan(value));
  EXPECT_FALSE(c.points[0].below_reference || c.points[0].force_below_reference || c.points[0].torque_below_reference);
}

#ifdef PALPATE_HAS_TOOL
// Its truth (rtol 1e-5 at the smallest period) has not enough steps, the rest has: the point stays, as one without an error.
TEST(Compare, AnExchangePeriodWithoutATruthHasNoError) {
  scene::Description d = small_scenes::pressed_block(0.001);
  d.duration_s = d.compare.duration_s = 0.02;
  d.integrator.max_steps = 12;
  d.compare.reference_rtol = d.compare.reference_check_rtol = 0.1;
  d.compare.reference_check = "cvode-bdf";
  d.compare.ladders = {{"linearly-implicit-euler", "step_s", {1e-3}}};
  d.compare.exchange_periods_s = {0.01};
  study::CompareOptions options;
  options.repeats = 1;
  const study::Comparison c = study::compare(d, options);
  ASSERT_EQ(c.exchange.size(), 1u);
  EXPECT_TRUE(std::isnan(c.exchange[0].error.force_rms_n) && std::isnan(c.exchange[0].error.position_rel_l2));
}
#endif

TEST(BenchFem, StagesAddUpToTheStep) {
  const study::FemBench b = study::bench_fem(8, 0.01, 4, "cholmod");
  EXPECT_EQ(b.nodes, 9 * 3 * 3);
  EXPECT_EQ(b.tetrahedra, 5 * 8 * 2 * 2);
  EXPECT_GT(b.force_ms, 0.0);
  EXPECT_GT(b.tangent_ms, 0.0);
  EXPECT_GT(b.factor_ms, 0.0);
  EXPECT_GT(b.solve_ms, 0.0);
  EXPECT_NEAR(b.force_ms + b.tangent_ms + b.factor_ms + b.solve_ms + b.other_ms, b.step_ms, 1e-12);
  EXPECT_THROW(study::bench_fem(2, 0.01, 4, "cholmod"), Error);
}

TEST(BenchLeaveOut, RefusesASceneThatLeavesNothingOut) {
  EXPECT_THROW(study::bench_leave_out(small_scenes::pressed_block(0.001), 1), Error);
}

}  // namespace
