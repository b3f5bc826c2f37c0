#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "page_charts.h"
#include "report/run_report.h"
#include "temporary_folder.h"

using namespace palpate;

namespace {

constexpr const char* kZWidthRows =
    "damping_n_s_m,k_passive_n_m,k_spectral_n_m,k_delay_bound_n_m,k_simulated_n_m,coupling_in_contact_n_m\n"
    "2,200,400,300,390,inf\n4,300,500,400,480,700\n3,250,450,350,nan,650\n";

std::string page_of(const TemporaryFolder& dir) {
  const report::RunReport written = report::write_run_report(dir.path());
  EXPECT_TRUE(written.missing_figures.empty());
  std::ifstream in(written.page, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

// Theory and simulation alternate in the file; the curves ascend in damping.
TEST(RunReportCharts, DrawsTheStiffnessThatAHapticLoopCanRender) {
  const TemporaryFolder dir;
  dir.write("z_width.csv", kZWidthRows);
  dir.write("summary.json", R"({"scene": "x", "figures": {
    "haptic_stability": {"coupling_damping_n_s_m": 2.5},
    "operating_points": [
      {"name": "tool in the air", "motion": "translation", "stiffness_with_coupling_n_m": 0},
      {"name": "stiffest contact", "motion": "translation", "stiffness_with_coupling_n_m": 120},
      {"name": "turned", "motion": "rotation", "stiffness_with_coupling_n_m_rad": 9}]}})");
  const nlohmann::json chart = chart_of(page_of(dir), "largest stiffness of the wall [N/m]");
  ASSERT_EQ(chart["series"].size(), 6u);
  EXPECT_EQ(chart["series"][0]["x"], (std::vector<double>{2, 3, 4}));
  EXPECT_EQ(chart["series"][0]["y"], (std::vector<double>{200, 250, 300}));
  EXPECT_EQ(chart["series"][3]["name"], "stable, simulated");
  EXPECT_EQ(chart["series"][3]["x"], (std::vector<double>{2, 4}));
  EXPECT_EQ(chart["series"][4]["y"], (std::vector<double>{650, 700})) << "an infinite limit is no point";
  EXPECT_EQ(chart["series"][5]["x"], (std::vector<double>{2.5}));
  EXPECT_EQ(chart["series"][5]["y"], (std::vector<double>{120}));
  EXPECT_EQ(chart["series"][5]["labels"], (std::vector<std::string>{"stiffest contact"}));
}

TEST(RunReportCharts, DrawsTheBenchmarksOfSteps) {
  const TemporaryFolder dir;
  dir.write("bench-fem.json", R"({"rows": [
    {"nodes": 800, "youngs_modulus_pa": 1e5, "step_s": 0.01, "linear_rtol": 1e-3, "linear_solver": "pcg",
      "threads": 2, "step_ms": 9},
    {"nodes": 100, "youngs_modulus_pa": 1e5, "step_s": 0.01, "linear_rtol": 1e-3, "linear_solver": "pcg",
      "threads": 1, "step_ms": 3},
    {"nodes": 800, "youngs_modulus_pa": 1e5, "step_s": 0.01, "linear_rtol": 1e-3, "linear_solver": "pcg",
      "threads": 1, "step_ms": 15}]})");
  dir.write("bench-fem-accuracy.json", R"({"points": [
    {"program": "palpate", "step_s": 0.01, "ms_of_ten_ms": 4, "error": 1e-2, "quoted": false},
    {"program": "another", "step_s": 0.01, "ms_of_ten_ms": 7, "error": 2e-2, "quoted": true}]})");
  const std::string html = page_of(dir);
  const nlohmann::json times = chart_of(html, "time of a step, median [ms]"),
                       errors = chart_of(html, "error of the final state, relative [-]");
  ASSERT_EQ(times["series"].size(), 2u);
  EXPECT_EQ(times["series"][0]["name"], "E 100000 Pa, 10 ms, 0.001, pcg, 1 thread");
  EXPECT_EQ(times["series"][0]["x"], (std::vector<double>{100, 800}));
  EXPECT_EQ(times["series"][0]["y"], (std::vector<double>{3, 15}));
  EXPECT_EQ(times["series"][1]["name"], "E 100000 Pa, 10 ms, 0.001, pcg, 2 threads");
  ASSERT_EQ(errors["series"].size(), 2u);
  EXPECT_EQ(errors["series"][0]["name"], "another (quoted)");
  EXPECT_EQ(errors["series"][1]["name"], "palpate, 10 ms");
}
