// No page of any kind of result shows "nan", "inf" or "null": every number of every file is removed in turn
// (all of them, those of the first line, those of the last), and the page's text is searched.
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "report/run_report.h"
#include "report/table.h"
#include "store/study_columns.h"
#include "temporary_folder.h"
#include "well_formed.h"

using namespace palpate;

namespace {

using Json = nlohmann::ordered_json;

std::string joined(const std::vector<std::string>& cells) {
  std::string line;
  for (const auto& cell : cells) line += (line.empty() ? "" : ",") + cell;
  return line + "\n";
}

std::string compare_csv() {
  std::string out = joined(store::compare_columns());
  const auto add = [&](const std::string& label, const std::string& setting_name, double setting,
                       double error, double cpu) {
    std::vector<std::string> cells(store::compare_columns().size());
    const auto set = [&](const char* column, const std::string& text) {
      const auto& columns = store::compare_columns();
      cells[static_cast<std::size_t>(std::find(columns.begin(), columns.end(), column) - columns.begin())] =
          text;
    };
    for (const auto& [column, text] : std::vector<std::pair<const char*, std::string>>{
             {"scene", "touch"},
             {"label", label},
             {"integrator", label},
             {"family", label},
             {"order", "1"},
             {"stability", "explicit"},
             {"multistep", "yes"},
             {"setting_name", setting_name},
             {"setting", fmt::format("{}", setting)},
             {"error_test_rtol", "1e-4"},
             {"position_error_rel_l2", fmt::format("{}", error)},
             {"position_error_max_m", "1e-5"},
             {"force_error_rms_n", fmt::format("{}", 3.0 * error)},
             {"force_error_max_n", "1e-3"},
             {"torque_error_rms_n_m", fmt::format("{}", 0.1 * error)},
             {"torque_error_max_n_m", "1e-4"},
             {"cpu_s_median", fmt::format("{}", cpu)},
             {"cpu_s_min", fmt::format("{}", 0.9 * cpu)},
             {"cpu_s_max", fmt::format("{}", 1.1 * cpu)},
             {"repeats", "3"},
             {"steps", "100"},
             {"force_evaluations", "200"},
             {"status", "ok"}})
      set(column, text);
    out += joined(cells);
  };
  for (int i = 0; i < 4; ++i) {
    add("cvode-bdf", "rtol", std::pow(10.0, -2 - i), std::pow(10.0, -2 - i), 1.0 + i);
    add("linearly-implicit-euler", "step_s", std::pow(10.0, -2 - i), 2.0 * std::pow(10.0, -2 - i),
        0.5 + 3 * i);
  }
  return out;
}

constexpr const char* kHaptic =
    "variable,value,setting,own,force_error_rms_n,force_error_rms_of_peak,force_error_max_of_peak,"
    "torque_error_rms_n_m,torque_error_rms_of_peak,torque_error_max_of_peak,force_unresolved,"
    "torque_unresolved,cpu_s_median,contact_query_s,linearise_s,tool_ticks_s,bodies_s,status,reason\n"
    "exchange period,20 ms,0.02,yes,0.04,0.02,0.03,0.1,0.2,0.3,no,no,1,0.1,0.1,0.1,0.7,ok,\n"
    "exchange period,10 ms,0.01,no,0.02,0.01,0.02,0.1,0.2,0.3,no,no,2,0.1,0.1,0.1,1.7,ok,\n"
    "exchange alone,20 ms,0.02,no,0.02,0.01,0.02,0.1,0.2,0.3,no,no,9,0.1,0.1,0.1,8.7,ok,\n"
    "exchange alone,10 ms,0.01,no,0.01,0.005,0.01,0.1,0.2,0.3,no,no,9,0.1,0.1,0.1,8.7,ok,\n"
    "tick,1 ms,0.001,yes,0.04,0.02,0.03,0.1,0.2,0.3,no,no,1,0.1,0.1,0.1,0.7,ok,\n";

/// One kind of result with the files of its folder. Numbers are removed from the first file.
struct Kind {
  const char* name;
  std::vector<std::pair<std::string, std::string>> files;
};

std::vector<Kind> kinds() {
  const std::pair<std::string, std::string> reference = {
      "reference.json",
      R"({"rules": "", "scenes": [{"scene": "touch", "position_error_rel_l2": 1e-9,
          "force_error_rms_n": 1e-9, "torque_error_rms_n_m": 1e-9, "peak_force_n": 1.2,
          "peak_torque_n_m": 0.3, "description": "made by one", "trouble": "", "notes": []}]})"};
  const std::pair<std::string, std::string> summary = {
      "summary.json",
      R"({"command": "palpate run x", "scene": "x", "outcome": "finished", "message": "", "overrides": [],
          "figures": {"options": {"integrator": "cvode-bdf"},
            "sizes": {"nodes": 30}, "counts": {"steps": 812},
             "timings": {"simulated_s": 0.5, "loop_cpu_s": 2},
            "hands": [{"name": "tool", "max_force_n": 2.5, "max_torque_n_m": 0.1, "peak_force_n": 1.2,
              "peak_force_at_s": 0.1, "peak_torque_n_m": 0.1, "peak_torque_at_s": 0.2}],
            "monolithic_reference": {"made_by": "one", "peak_force_n": 2, "force_error_rms_n": 1e-3},
            "observed_orders": [{"variable": "exchange alone", "force_order": 1.0}],
            "against_monolithic": [{"hand": "tool", "force_error_rms_of_peak": 0.02,
              "torque_error_rms_of_peak": 0.01}],
            "operating_points": [{"name": "tool in the air", "contact_stiffness_n_m": 0,
              "spectral_radius": 0.9}]}})"};
  return {
      {"summary", {summary}},
      {"force",
       {{"force.csv",
         "time_s,force_x_n,force_y_n,force_z_n,torque_x_n_m,torque_y_n_m,torque_z_n_m\n"
         "0,0,0,0.1,0,0,0.1\n0.001,0,0,1,0,0,0.2\n0.002,0,0,2,0,0,0.1\n"},
        summary}},
      {"clock", {{"clock.csv", "time_s,late_us,work_us\n0.001,3,50\n0.002,4,60\n0.003,5,70\n"}, summary}},
      {"trace",
       {{"trace.csv",
         "time_s,step_s,order,error,newton_iterations,outcome,worst_body,worst_node,worst_axis,"
         "inverted_body,inverted_element\n0,0.004,3,7.5,2,error test,liver,2,y,,\n"
         "0,0.001,3,0.5,2,accepted,liver,0,x,,\n0.001,0.002,3,0.2,9,Newton,,,,liver,12\n"
         "0.001,0.001,3,0.4,2,accepted,liver,0,x,,\n"}}},
      {"compare", {{"compare.csv", compare_csv()}, reference}},
      {"reference", {reference, {"compare.csv", compare_csv()}}},
      {"restarts",
       {{"restarts.csv", joined(store::restart_columns()) +
                             "touch,a,cvode-bdf,yes,0.01,0.5,3,100,120,20,0.1,ok,\n"
                             "touch,a,cvode-bdf,yes,0.001,0.5,30,400,500,60,0.3,ok,\n"}}},
      {"exchange",
       {{"exchange.csv",
         "exchange_period_s,position_error_rel_l2,force_error_rms_n,torque_error_rms_n_m,cpu_s\n"
         "0.02,2e-2,1,1,1\n0.01,1e-2,0.5,0.5,2\n0.005,5e-3,0.25,0.25,4\n"}}},
      {"methods",
       {{"methods.csv",
         "scene,method,position_difference_rel_l2,position_difference_max_m,force_difference_rms_n,"
         "force_difference_max_n,peak_force_n,most_samples,query_s,cpu_s\n"
         "touch,analytic,0,0,0,0,1.2,4,0.1,1\ntouch,cpu,0.3,1e-3,0.1,0.2,1.1,300,0.2,2\n"}}},
      {"haptic", {{"haptic.csv", kHaptic}, summary}},
      {"study",
       {{"study.csv",
         "task,scene,integrator,rtol,body.0.youngs_modulus_pa,seed,body.0.density_kg_m3,status,reason,"
         "peak_force_n,steps,end_state\n0,a,cvode-bdf,0.001,1e3,1,900,ok,,1,10,aa\n"
         "1,a,cvode-bdf,0.001,1e3,2,1100,ok,,3,11,ab\n2,a,cvode-bdf,0.001,1e5,1,900,ok,,5,12,ac\n"},
        {"study-times.csv", "task,status,loop_cpu_s\n0,ok,1\n1,ok,2\n2,ok,3\n"}}},
      {"z-width",
       {{"z_width.csv",
         "damping_n_s_m,k_passive_n_m,k_spectral_n_m,k_delay_bound_n_m,k_simulated_n_m,"
         "coupling_in_contact_n_m\n1,200,400,300,390,600\n2,300,500,400,480,700\n"},
        summary}},
      {"validation",
       {{"validation.json", R"({"cases": [{"name": "patch", "summary": "s", "wall_s": 2.5, "measurements": [
           {"quantity": "q", "computed": 1.5, "exact": 1, "error": 1e-4, "bar": 1e-3, "order": 0.83,
            "order_low": 0.8, "order_high": 1.2, "passed": true, "refinement": {"size_label": "h [m]",
            "size": [4e-3, 2e-3, 1e-3], "error": [16e-4, 4e-4, 1e-4],
             "wall_s": [1e-3, 4e-3, 16e-3]}}]}]})"}}},
      {"stability",
       {{"stability.json", R"({"unexpected": 0, "wall_s": 3.0, "rows": [{"name": "m", "summary": "s"}],
           "cells": [{"row": "m", "sub_case": "E", "integrator": "a", "verdict": "accurate",
             "expected": ["accurate"], "as_expected": true, "figure": "f", "reason": "", "steps": 12,
             "cpu_s": 0.01}]})"}}},
      {"bench-fem", {{"bench-fem.json", R"({"rows": [
           {"nodes": 100, "step_s": 0.01, "linear_solver": "pcg", "threads": 1, "step_ms": 9},
           {"nodes": 100, "step_s": 0.01, "linear_solver": "cg", "threads": 2, "step_ms": 7}]})"}}},
      {"bench-fem-accuracy", {{"bench-fem-accuracy.json", R"({"points": [
           {"program": "palpate", "step_s": 0.01, "ms_of_ten_ms": 4, "error": 1e-2, "quoted": false}]})"}}},
      {"bench-contact", {{"bench-contact.json", R"({"scenes": [{"scene": "gears", "rows": [
           {"method": "cpu", "query_ms": {"least": 1, "median": 2.5}}]}],
           "bars": [{"scene": "gears", "what": "query", "value": 3, "at_most": 2, "met": false}]})"}}}};
}

bool is_number(const std::string& cell) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc{} && end == cell.data() + cell.size();
}

/// Lines of a table, or numbers of a JSON file, that lose their value.
enum class Lost { kNone, kAll, kFirst, kLast };

std::string csv_without(const std::string& text, Lost lost, const std::string& word) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  std::string out = lines[0] + "\n";
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const bool take = lost == Lost::kAll || (lost == Lost::kFirst && i == 1) ||
                      (lost == Lost::kLast && i + 1 == lines.size());
    std::string line;
    std::istringstream cells(lines[i] + ",");
    for (std::string cell; std::getline(cells, cell, ',');)
      line += (line.empty() ? "" : ",") + (take && is_number(cell) ? word : cell);
    out += line + "\n";
  }
  return out;
}

/// @param seen  number of numbers visited so far
void take_from_json(Json& json, Lost lost, int& seen) {
  if (json.is_structured())
    for (Json& inner : json) take_from_json(inner, lost, seen);
  if (!json.is_number()) return;
  ++seen;
  const bool take =
      lost == Lost::kAll || (lost == Lost::kFirst && seen % 2 == 1) || (lost == Lost::kLast && seen % 2 == 0);
  if (take) json = nullptr;
}

std::string text_of_page(const Kind& kind, Lost lost, const std::string& word) {
  const TemporaryFolder dir;
  for (std::size_t i = 0; i < kind.files.size(); ++i) {
    auto [name, text] = kind.files[i];
    if (i == 0 && lost != Lost::kNone) {
      if (name.ends_with(".csv")) {
        text = csv_without(text, lost, word);
      } else {
        Json json = Json::parse(text);
        int seen = 0;
        take_from_json(json, lost, seen);
        text = json.dump();
      }
    }
    dir.write(name, text);
  }
  std::ifstream in(report::write_run_report(dir.path()).page);
  std::string html{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(well_formed_problem(html), "");
  for (const char* element : {"script", "style"})
    for (std::size_t at = 0; (at = html.find(fmt::format("<{}", element), at)) != std::string::npos;)
      html.erase(at, html.find(fmt::format("</{}>", element), at) + 3 + std::string(element).size() - at);
  html = std::regex_replace(html, std::regex(" title=\"([^\"]*)\""), "> $1 <");  // shown as a tooltip
  return std::regex_replace(html, std::regex("<[^>]*>"), " ");
}

class FinitePages : public testing::TestWithParam<std::size_t> {};

TEST_P(FinitePages, ShowNoNumberThatIsNone) {
  const Kind kind = kinds()[GetParam()];
  const std::regex none(R"(\b(nan|inf|infinity|null|undefined)\b)", std::regex::icase);
  std::set<std::string> pages;
  for (const Lost lost : {Lost::kNone, Lost::kAll, Lost::kFirst, Lost::kLast})
    for (const char* word : {"nan", "inf", "-nan"}) {
      SCOPED_TRACE(fmt::format("{}, pattern {}, {}", kind.name, static_cast<int>(lost), word));
      const std::string text = text_of_page(kind, lost, word);
      pages.insert(text);
      std::smatch found;
      EXPECT_FALSE(std::regex_search(text, found, none))
          << text.substr(std::max<std::ptrdiff_t>(0, found.position() - 120), 240);
      if (lost == Lost::kNone || !kind.files[0].first.ends_with(".csv")) break;
    }
  EXPECT_GE(pages.size(), 2u) << "the numbers are on the page";
}

INSTANTIATE_TEST_SUITE_P(Kinds, FinitePages, testing::Range<std::size_t>(0, kinds().size()),
                         [](const auto& one) {
                           std::string name = kinds()[one.param].name;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
