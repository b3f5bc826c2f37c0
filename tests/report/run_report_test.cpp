#include "palpate/report/run_report.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "palpate/core/error.h"
#include "palpate/report/work_precision.h"
#include "palpate/store/study_columns.h"
#include "temporary_folder.h"
#include "well_formed.h"

using namespace palpate;
namespace fs = std::filesystem;

namespace {

void put(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

std::string read(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string joined(const std::vector<std::string>& cells) {
  std::string line;
  for (const auto& cell : cells) line += (line.empty() ? "" : ",") + cell;
  return line + "\n";
}

/// Every file that a report is made from, small.
void fill(const TemporaryFolder& dir) {
  put(dir / "summary.json",
      R"({"command": "palpate run press-ball", "scene": "press <ball>", "outcome": "finished",
        "message": "", "overrides": ["a=1"],
      "figures": {"options": {"integrator": "cvode-bdf", "max_force_n": 2.5}, "counts": {"steps": 812},
        "monolithic reference": {"made_by": "one <system>", "peak_force_n": 2, "own_force_error_rms_n": 1e-3},
        "observed orders": {"exchange alone: force": 1.0},
        "in_use": {"fem": "a soft body"},
      "left_out": {"proxy": "one body"}, "pictures": {"picture-of-it.png": "The ball & its dent"}},
      "provenance": {"version": "0.1.0", "commit": "abc", "libraries": {"Eigen": "3.4.0"}}})");
  put(dir / "scene.toml", "name = \"press <ball>\" # a & b\n");
  put(dir / "force.csv", "time_s,force_x_n,force_y_n,force_z_n\n0,0,0,0\n0.001,0,0,1\n0.002,0,0,2\n");
  std::string compare = joined(store::compare_columns());
  for (const char* line : {"1e-3,1e-3,1", "1e-4,1e-4,2", "1e-5,1e-5,4"}) {
    const std::string text = line;
    const auto first = text.find(','), last = text.rfind(',');
    compare += "press,cvode_<bdf>,cvode-bdf,BDF,5,A(alpha),yes,rtol," + text.substr(0, first) +
               ",1e-7,yes,cholmod,ark-erk-5," + text.substr(first + 1, last - first - 1) + ",,,,,,," +
               text.substr(last + 1) + ",1,4,1,0.1,0.1,3,10,2,3,10,12,9,8,1,0,ok,,no,no,no\n";
  }
  put(dir / "compare.csv", compare);
  put(dir / "reference.json",
      R"({"rules": "one run a point", "scenes": [{"scene": "press", "position_error_rel_l2": 1e-6,
        "force_error_rms_n": null, "torque_error_rms_n_m": null,
      "description": "cvode-bdf at 1e-9", "trouble": "", "notes": []}]})");
  put(dir / "restarts.csv", joined(store::restart_columns()) +
                                "press,cvode_<bdf>,cvode-bdf,yes,0.01,0.5,3,100,120,20,0.1,ok,\npress,cvode_<"
                                "bdf>,cvode-bdf,yes,0.001,0.5,30,400,500,60,0.3,ok,\n");
  put(dir / "exchange.csv",
      joined(report::exchange_columns()) + "0.02,2e-2,,,1\n0.01,1e-2,,,2\n0.005,5e-3,,,4\n");
  put(dir / "haptic.csv",
      "variable,value,setting,own,force_error_rms_n,force_error_rms_of_peak,force_error_max_of_peak,"
      "torque_error_rms_n_m,torque_error_rms_of_peak,torque_error_max_of_peak,force_unresolved,"
      "torque_unresolved,cpu_s_median,contact_query_s,linearise_s,tool_ticks_s,bodies_s,status,reason\n"
      "exchange period,20 ms,0.02,yes,0.04,0.02,0.03,0,nan,nan,no,no,1,0.1,0.1,0.1,0.7,ok,\n"
      "exchange period,10 ms,0.01,no,0.02,0.01,0.02,0,nan,nan,no,no,2,0.1,0.1,0.1,1.7,ok,\n"
      "exchange alone,20 ms,0.02,no,0.02,0.01,0.02,0,nan,nan,no,no,9,0.1,0.1,0.1,8.7,ok,\n"
      "exchange alone,10 ms,0.01,no,0.01,0.005,0.01,0,nan,nan,yes,no,9,0.1,0.1,0.1,8.7,ok,\n"
      "exchange alone,5 ms,0.005,no,0.005,0.0025,0.005,0,nan,nan,no,no,9,0.1,0.1,0.1,8.7,ok,\n"
      "tick,1 ms,0.001,yes,0.04,0.02,0.03,0,nan,nan,no,no,1,0.1,0.1,0.1,0.7,ok,\n"
      "linearisation,fro<zen>,nan,no,nan,nan,nan,nan,nan,nan,no,no,nan,nan,nan,nan,nan,refused,no <such>\n");
  put(dir / "validation.json", R"({"cases": [{"name": "patch-test", "measurements": [
      {"quantity": "stress [Pa]", "computed": 1, "exact": 1, "error": 0, "bar": 1e-6, "order": null,
        "passed": true},
      {"quantity": "broken [m]", "computed": 2, "exact": 1, "error": 1, "bar": 1e-6, "order": null,
        "passed": false},
      {"quantity": "volume [m^3]", "computed": 2, "exact": 1, "error": 1e-4, "bar": 1e-3, "order": 2,
        "passed": true, "refinement": {"size_label": "pixel edge [m]", "size": [4e-3, 2e-3, 1e-3],
        "error": [16e-4, 4e-4, 1e-4], "wall_s": [1e-3, 4e-3, 16e-3]}}]}]})");
  put(dir / "picture-of-it.png", "\x89PNG\r\n\x1a\n");
}

}  // namespace

TEST(RunReport, HoldsEverySectionAndNothingFromOutside) {
  const TemporaryFolder dir;
  fill(dir);
  const report::RunReport report = report::write_run_report(dir.path());
  EXPECT_TRUE(report.missing_figures.empty());
  const std::string html = read(report.page);
  EXPECT_EQ(well_formed_problem(html), "");
  for (const char* text : {"palpate: press &lt;ball&gt;",
                           "The ball &amp; its dent",
                           "palpate run press-ball",
                           "<td class=\"n\">812</td>",
                           "a soft body",
                           "3.4.0",
                           "Force on the hand",
                           "device limit 2.5 N",
                           "Error against run time",
                           "cvode_&lt;bdf&gt;",
                           "Reference: cvode-bdf at 1e-9",
                           "one run a point",
                           "the reference's own error",
                           "Cheapest for a wanted error",
                           "Cost of a wanted error",
                           "What a restart costs",
                           "(multistep)",
                           "Fitted order",
                           "1.00 (3 points)",
                           "Error of the exchange period",
                           "fitted order 1.00",
                           "Force on the hand against one system",
                           "Reference: one &lt;system&gt;.",
                           "against the haptic rate",
                           "order 1.00",
                           "20 ms (the scene&#39;s)",
                           "not resolved",
                           "no &lt;such&gt;",
                           "patch-test",
                           "FAIL",
                           "1 of 3 measurements FAIL",
                           "volume [m^3] (order 2.00)",
                           "patch-test: error against pixel edge [m].",
                           "patch-test: error against run time.",
                           "left out",
                           "one body",
                           "Provenance",
                           "abc",
                           "# a &amp; b"})
    EXPECT_NE(html.find(text), std::string::npos) << text;
  for (const char* outside :
       {"http:", "https:", "src=\"/", "src=\"file", "@import", "url(", "<link", "<script"})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  EXPECT_EQ(html.find("Figure not drawn"), std::string::npos);
}

TEST(RunReport, LeavesOutSectionsWithoutAFile) {
  const TemporaryFolder dir;
  put(dir / "summary.json", R"({"scene": "one-tet"})");
  const std::string html = read(report::write_run_report(dir.path()).page);
  EXPECT_NE(html.find("palpate: one-tet"), std::string::npos);
  for (const char* text : {"Force on the hand", "Error against run time", "Validation", "Provenance"})
    EXPECT_EQ(html.find(text), std::string::npos) << text;
}

TEST(RunReport, GivesTheReasonInPlaceOfAFigureThatCannotBeDrawn) {
  const TemporaryFolder dir;
  put(dir / "force.csv", "time_s,force_x_n,force_y_n,force_z_n\n");
  const report::RunReport report = report::write_run_report(dir.path());
  EXPECT_NE(read(report.page).find("Figure not drawn"), std::string::npos);
  ASSERT_FALSE(report.missing_figures.empty()) << "whoever prints the last line must know";
  EXPECT_NE(report.missing_figures[0].why.find("nothing to draw"), std::string::npos)
      << report.missing_figures[0].why;
}

TEST(RunReport, RefusesADirectoryWithoutResults) {
  try {
    report::write_run_report(TemporaryFolder().path());
    FAIL() << "an empty directory was accepted";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("holds no results to report"), std::string::npos);
  }
  EXPECT_THROW(report::write_run_report("/nowhere"), Error);
}

TEST(RunReport, NamesAFileThatIsBroken) {
  const TemporaryFolder dir;
  put(dir / "summary.json", "{\"scene\": ");
  try {
    report::write_run_report(dir.path());
    FAIL() << "broken JSON was accepted";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("summary.json: is not valid JSON"), std::string::npos);
  }
}
