#include "report/run_report.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/missing_outputs.h"
#include "page_charts.h"
#include "palpate/core/error.h"
#include "report/work_precision.h"
#include "store/study_columns.h"
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

/// Removes library scripts from the page; the numbers of charts remain.
std::string without_scripts(std::string html) {
  for (std::size_t at = html.find("<script>"); at != std::string::npos; at = html.find("<script>", at))
    html.erase(at, html.find("</script>", at) + 9 - at);
  return html;
}

/// Writes a small version of every file from which a report is made.
void fill(const TemporaryFolder& dir) {
  put(dir / "summary.json",
      R"({"command": "palpate run press-ball", "scene": "press <ball>", "outcome": "finished",
        "message": "", "overrides": ["a=1"],
      "figures": {"options": {"integrator": "cvode-bdf"}, "counts": {"steps": 812},
        "hands": [{"name": "tool", "max_force_n": 2.5}, {"name": "left", "rejected_ticks": 77}],
        "contacts": [{"between": ["left", "press <ball>"], "deepest_overlap_m": 1e-3}],
        "monolithic_reference": {"made_by": "one <system>", "peak_force_n": 2, "force_error_rms_n": 1e-3},
        "observed_orders": [{"variable": "tick", "force_order": 3},
          {"variable": "exchange alone", "force_order": 1.0}],
        "against_monolithic": [{"hand": "tool", "force_error_rms_of_peak": 0.02}],
        "parts": [{"name": "fem", "used": true, "why": "a soft body"},
          {"name": "proxy", "used": false, "why": "one body"}]},
      "provenance": {"version": "0.1.0", "commit": "abc",
        "libraries": [{"name": "Eigen", "version": "3.4.0"}]}})");
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
  const std::string page = read(report.page), html = without_scripts(page);
  EXPECT_EQ(well_formed_problem(page), "");
  EXPECT_NE(page, html) << "a table that can be sorted needs the script";
  for (const char* text :
       {"Run, comparison, haptic comparison and validation: press &lt;ball&gt;",
        "Picture of it",
        "hand: left",
        "rejected ticks",
        "contact: left - press &lt;ball&gt;",
        "deepest overlap [m]",
        "palpate run press-ball",
        "<td class=\"n\">812</td>",
        "a soft body",
        "3.4.0",
        "Force on the hand",
        "device limit 2.5 N",
        "Error against run time",
        "cvode_&lt;bdf&gt; is the cheapest at every target error that is reached and resolved.",
        "The peak force on the hand is 2 N at 0.002 s (device limit 2.5 N).",
        "cvode_&lt;bdf&gt;",
        "Reference: cvode-bdf at 1e-9",
        "one run a point",
        "reference error",
        "Cheapest integrator for a target error",
        "Cost of a target error",
        "Cost of restarts",
        "(multistep)",
        "Fitted order",
        "1.00 (3 points)",
        "Error due to the exchange period",
        "fitted order 1.00",
        "Force on the hand against the monolithic solution",
        "the force on the hand against the monolithic solution is 2 % of the peak",
        "The most accurate variant is exchange period = 10 ms: error 1 %, 2 s of CPU time.",
        "Reference: one &lt;system&gt;.",
        "against the haptic rate",
        "order 1.00",
        "20 ms (the scene&#39;s)",
        "not resolved",
        "no &lt;such&gt;",
        "patch-test",
        "FAIL",
        "1 of 3 measurements are outside their acceptance limits.",
        "They are: patch-test, broken [m].",
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
       {"http:", "https:", "src=\"/", "src=\"file", "@import", "url(", "<link", "<script src"})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  EXPECT_EQ(html.find("Figure not drawn"), std::string::npos);
}

TEST(RunReport, EmbedsTheResultsNumbersInItsCharts) {
  const TemporaryFolder dir;
  fill(dir);
  const std::string html = read(report::write_run_report(dir.path()).page);
  const nlohmann::json force = chart_of(html, "force on the hand [N]");
  ASSERT_EQ(force["series"].size(), 4u);
  EXPECT_EQ(force["series"][3]["name"], "magnitude");
  EXPECT_EQ(force["series"][3]["x"], (std::vector<double>{0, 0.001, 0.002}));
  EXPECT_EQ(force["series"][3]["y"], (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(force["levels"][0]["y"], 2.5);
  const nlohmann::json error = chart_of(html, "position error, relative L2 [-]");
  EXPECT_EQ(error["series"][0]["x"], (std::vector<double>{1, 2, 4}));
  EXPECT_EQ(error["series"][0]["y"], (std::vector<double>{1e-3, 1e-4, 1e-5}));
  EXPECT_EQ(error["series"][0]["notes"][2], "1e-5");
  EXPECT_EQ(error["floor_y"], 1e-6);
}

// Main results first: words before tables, the first chart open, charts of counts behind a switch.
TEST(RunReport, AnswersFirstAndFoldsAwaySecondQuestions) {
  const TemporaryFolder dir;
  fill(dir);
  const std::string html = without_scripts(read(report::write_run_report(dir.path()).page));
  const std::size_t answer = html.find("class=\"answer\""), words = html.find("is the cheapest"),
                    table = html.find("<table"), chart = html.find("against CPU time; lower left"),
                    fold = html.find("<summary>Position error against force evaluations"),
                    counts = html.find("against force evaluations, independent of timing noise"),
                    end = html.find("</details>", fold);
  ASSERT_NE(fold, std::string::npos);
  EXPECT_LT(answer, words);
  EXPECT_LT(words, table);
  EXPECT_LT(table, chart);
  EXPECT_LT(chart, fold);
  EXPECT_LT(fold, counts);
  EXPECT_LT(counts, end) << "a chart of counts stands in the open";
  EXPECT_EQ(html.find("<details open"), std::string::npos);
}

TEST(RunReport, SortsByNumbersWhereCellsBeginWithOne) {
  report::Page page("t");
  page.add_table({"name", "cost", "ratio", "mixed"},
                 {{"a", "<= 0.1", "1.50 (1.31 to 1.72)", "3"}, {"b", "2", "-", "none"}});
  const std::string html = page.html();
  for (const char* header : {"data-sort=\"text\">name", "data-sort=\"number\">cost",
                             "data-sort=\"number\">ratio", "data-sort=\"text\">mixed"})
    EXPECT_NE(html.find(header), std::string::npos) << header;
  EXPECT_NE(html.find("<script>"), std::string::npos);
  page = report::Page("t");
  page.add_table({"name"}, {{"a"}});
  EXPECT_EQ(page.html().find("<script"), std::string::npos) << "one row cannot be sorted";
}

TEST(RunReport, TakesAnyMixOfResults) {
  const TemporaryFolder run, checks, bench, out;
  put(run / "summary.json", R"({"scene": "one-tet", "outcome": "finished",
    "figures": {"options": {"integrator": "cvode-bdf"}, "timings": {"simulated_s": 0.5, "loop_cpu_s": 2}}})");
  put(checks / "validation.json", R"([{"name": "patch-test", "measurements": [
    {"quantity": "stress", "computed": 1, "exact": 1, "error": 1e-7, "bar": 1e-6, "passed": true}]}])");
  put(bench / "bench-fem.json", R"({"rows": [
    {"nodes": 100, "step_s": 0.01, "linear_solver": "slow<er>", "threads": 1, "step_ms": 9},
    {"nodes": 100, "step_s": 0.01, "linear_solver": "pcg", "threads": 2, "step_ms": 7}]})");
  const report::RunReport written =
      report::write_report({run.path(), checks.path(), bench.path()}, out / "all.html");
  EXPECT_EQ(written.page, out / "all.html");
  const std::string html = without_scripts(read(written.page));
  EXPECT_EQ(well_formed_problem(html), "");
  std::size_t at = 0;
  for (const char* text :
       {"<nav", "href=\"#result-1\">Run: one-tet",
        "The run finished: 0.5 s simulated in 2 s of CPU time by cvode-bdf.", "href=\"#result-2\">Validation",
        "the one measurement of 1 case meets the acceptance limit", "href=\"#result-3\">Benchmark",
        "100 nodes, steps of 10 ms: 7 ms by pcg on 2 threads.", "</nav>", "id=\"result-1\"",
        "id=\"result-2\"", "10 % of the limit", "patch-test", "id=\"result-3\"", "slow&lt;er&gt;"}) {
    const std::size_t found = html.find(text, at);
    ASSERT_NE(found, std::string::npos) << text << " is not there, or not in its order";
    at = found;
  }
}

TEST(RunReport, TurnsEveryListOfABenchmarkIntoATable) {
  const TemporaryFolder bench;
  put(bench / "bench-contact.json", R"({"processor": "a cpu", "scenes": [{"scene": "gears", "rows": [
      {"method": "cpu", "query_ms": {"least": 1, "median": 2.5}},
      {"method": "gpu", "query_ms": {"least": 3, "median": 4}, "device": "a gpu"}]}],
    "growth": [], "bars": [{"scene": "gears", "what": "query [ms]", "value": 3, "at_most": 2, "met": false},
      {"scene": "heads", "what": "query [ms]", "value": 1, "at_most": 2, "met": true}]})");
  const std::string html = without_scripts(read(report::write_run_report(bench.path()).page));
  EXPECT_EQ(well_formed_problem(html), "");
  for (const char* text :
       {"1 of 2 figures are outside their acceptance limits.", "They are: gears, query [ms].", "a cpu",
        "scenes, gears: rows", "query [ms], median",
        "<td>cpu</td><td class=\"n\">1</td><td class=\"n\">2.5</td><td>-</td>",
        "<td>gpu</td><td class=\"n\">3</td><td class=\"n\">4</td><td>a gpu</td>"})
    EXPECT_NE(html.find(text), std::string::npos) << text;
}

TEST(RunReport, RefusesAMixThatHoldsAnEmptyFolderAndNamesIt) {
  const TemporaryFolder run, empty;
  put(run / "summary.json", R"({"scene": "one-tet"})");
  try {
    report::write_report({run.path(), empty.path()}, run / "page.html");
    FAIL() << "an empty directory was accepted";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(empty.string() + ": contains no results"), std::string::npos)
        << e.what();
  }
  EXPECT_FALSE(fs::exists(run / "page.html"));
}

// Warnings and verdicts of every kind of result are in the head of its page, before the first section.
TEST(RunReport, HasTheRemarksOfTheCommandInItsHead) {
  const std::string summary =
      R"({"scene": "x", "outcome": "finished", "remarks": ["bodies & contact at 21.7 Hz", "not passive"]})";
  const std::vector<std::pair<const char*, const char*>> kinds = {
      {"force.csv", "time_s,force_x_n,force_y_n,force_z_n\n0,0,0,0\n0.001,0,0,1\n"},
      {"z_width.csv",
       "damping_n_s_m,k_passive_n_m,k_spectral_n_m,k_delay_bound_n_m,k_simulated_n_m,"
       "coupling_in_contact_n_m\n1,200,400,300,390,600\n"},
      {"study.csv", "task,scene,integrator,status,reason,steps\n0,a,bdf2,ok,,3\n"},
      {"stability.json", R"({"cells": []})"},
      {"validation.json", R"({"cases": []})"}};
  for (const auto& [file, text] : kinds) {
    const TemporaryFolder dir;
    put(dir / "summary.json", summary);
    put(dir / file, text);
    const std::string html = without_scripts(read(report::write_run_report(dir.path()).page));
    const std::string head = html.substr(0, html.find("<h2>"));
    for (const char* remark : {"<li>bodies &amp; contact at 21.7 Hz</li>", "<li>not passive</li>"})
      EXPECT_NE(head.find(remark), std::string::npos) << file << ": " << remark;
  }
}

TEST(RunReport, LeavesOutSectionsWithoutAFile) {
  const TemporaryFolder dir;
  put(dir / "summary.json", R"({"scene": "one-tet"})");
  const std::string html = read(report::write_run_report(dir.path()).page);
  EXPECT_NE(html.find("Run: one-tet"), std::string::npos);
  for (const char* text : {"Force on the hand", "Error against run time", "Validation", "Provenance"})
    EXPECT_EQ(html.find(text), std::string::npos) << text;
}

TEST(RunReport, SaysThePeakOfAForceThatWasNotRecorded) {
  const TemporaryFolder dir;
  const std::string before = R"({"scene": "x", "outcome": "finished", "figures": {
    "hands": [{"name": "tool", "max_force_n": 3.3, "peak_force_n": 1.25, "peak_force_at_s": 0.13,
      "peak_torque_n_m": )";
  put(dir / "summary.json", before + R"(0.002, "peak_torque_at_s": 0.2}]}})");
  std::string html = read(report::write_run_report(dir.path()).page);
  for (const char* text : {"The peak force on the hand is 1.25 N at 0.13 s (device limit 3.3 N).",
                           "The peak torque on the hand is 0.002 N m at 0.2 s."})
    EXPECT_NE(html.find(text), std::string::npos) << text;
  put(dir / "force.csv", "time_s,force_x_n,force_y_n,force_z_n\n0,0,0,0\n0.001,0,0,1\n0.002,0,0,2\n");
  html = read(report::write_run_report(dir.path()).page);
  EXPECT_NE(html.find("The peak force on the hand is 2 N"), std::string::npos)
      << "what was recorded goes first";
}

TEST(RunReport, WritesOneMomentInOneWay) {
  const TemporaryFolder dir;
  put(dir / "summary.json", R"({"scene": "x", "outcome": "finished", "figures": {
    "timings": {"simulated_s": 1.2345, "loop_cpu_s": 1},
    "hands": [{"name": "tool", "peak_force_n": 1, "peak_force_at_s": 1.2340000000000002}]}})");
  const std::string html = read(report::write_run_report(dir.path()).page);
  EXPECT_NE(html.find("1.2345 s simulated"), std::string::npos);
  EXPECT_NE(html.find("is 1 N at 1.234 s."), std::string::npos) << "no digit is cut off, no rounding shown";
}

TEST(RunReport, MissesNoFigureOfARunThatWasKilledBeforeItsFirstTick) {
  const TemporaryFolder dir;
  put(dir / "force.csv", "time_s,force_x_n,force_y_n,force_z_n\n");
  const report::RunReport report = report::write_run_report(dir.path());
  EXPECT_NE(read(report.page).find("No tick was written before the run ended."), std::string::npos);
  EXPECT_TRUE(report.missing_figures.empty());
}

TEST(RunReport, GivesTheReasonInPlaceOfAFigureThatCannotBeDrawn) {
  const TemporaryFolder dir;
  put(dir / "force.csv", "time_s,force_x_n,force_y_n,force_z_n\nnan,0,0,1\n");
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
    EXPECT_NE(std::string(e.what()).find("contains no results to report"), std::string::npos);
  }
  EXPECT_THROW(report::write_run_report("/nowhere"), Error);
}

TEST(RunReport, RefusesAnotherSchema) {
  const TemporaryFolder dir;
  put(dir / "summary.json", R"({"schema_version": 1000, "scene": "one-tet"})");
  try {
    report::write_run_report(dir.path());
    FAIL() << "another schema was accepted";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("schema_version is 1000"), std::string::npos);
  }
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

TEST(RunReport, FiguresThatAreMissingAreGroupedByReason) {
  report::RunReport page;
  page.page = "out/report.html";
  page.missing_figures = {{"force", "no ffmpeg"}, {"energy", "no ffmpeg"}, {"bodies", "too large"}};
  MissingOutputs missing;
  report::add_missing(page, missing);
  EXPECT_EQ(missing.outputs(),
            (std::vector<std::string>{"2 figures in out/report.html (no ffmpeg)",
                                      "figure \"bodies\" in out/report.html (too large)"}));
}
