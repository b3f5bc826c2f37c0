#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "report/run_report.h"
#include "temporary_folder.h"
#include "well_formed.h"

using namespace palpate;
namespace fs = std::filesystem;

namespace {

constexpr const char* kStability = R"({"unexpected": 1, "stopped": false, "wall_s": 3.0,
  "rows": [{"name": "modulus", "summary": "E & H, <stiff>"}, {"name": "thrown", "summary": "a handle"}],
  "cells": [
    {"row": "modulus", "sub_case": "E = 1e3", "integrator": "a<b>", "verdict": "accurate",
     "expected": ["accurate", "stable"], "as_expected": true,
     "figure": "energy +1e-07", "energy_gain": 1e-7, "error": null, "reason": "", "steps": 12, "cpu_s": 0.01},
    {"row": "modulus", "sub_case": "E = 1e3", "integrator": "second", "verdict": "grew",
     "expected": ["accurate"], "as_expected": false,
     "figure": "energy +9e+99", "energy_gain": 9e99, "error": null, "reason": "", "steps": 12, "cpu_s": 0.01},
    {"row": "modulus", "sub_case": "E = 1e4", "integrator": "second", "verdict": "error",
     "expected": ["error"], "as_expected": true,
     "figure": "", "energy_gain": null, "error": null, "reason": "second: \"too\" <much> work", "steps": 12,
     "cpu_s": 0.01},
    {"row": "thrown", "sub_case": "jumps", "integrator": "tool: x", "verdict": "stable",
     "expected": ["stable"], "as_expected": true,
     "figure": "", "energy_gain": null, "error": null, "reason": "", "steps": 0, "cpu_s": 0.01}]})";

std::string page_of(const std::string& json) {
  const TemporaryFolder dir;
  dir.write("stability.json", json);
  std::ifstream in(report::write_run_report(dir.path()).page);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

}  // namespace

TEST(StabilitySection, IsAMapOfLettersWithTheUnexpectedOutlined) {
  const std::string page = page_of(kStability);
  EXPECT_EQ(well_formed_problem(page), "");
  EXPECT_NE(page.find("1 of 4 cells do not end as theory predicts"), std::string::npos);
  EXPECT_EQ(count(page, "<table class=\"heat\">"), 2u) << "soft bodies and tools do not share columns";
  EXPECT_EQ(count(page, "<td class=\"v4 odd\""), 1u);
  EXPECT_EQ(count(page, "<td class=\"v0\""), 1u);
  EXPECT_EQ(count(page, "<td class=\"none\"></td>"), 1u) << "no cell of a<b> at E = 1e4";
  EXPECT_NE(page.find("a&lt;b&gt;"), std::string::npos);
  EXPECT_NE(page.find("E &amp; H, &lt;stiff&gt;"), std::string::npos);
  EXPECT_NE(page.find("expected: accurate or stable"), std::string::npos);
  EXPECT_NE(page.find("second: &quot;too&quot; &lt;much&gt; work"), std::string::npos)
      << "what the clear ends said";
  EXPECT_NE(page.find("Cells that differ from theory"), std::string::npos);
}

TEST(StabilitySection, SaysWhenAllIsAsExpected) {
  std::string json = kStability;
  json.replace(json.find("\"grew\""), 6, "\"accurate\"");
  json.replace(json.find("\"as_expected\": false"), 20, "\"as_expected\": true");
  const std::string page = page_of(json);
  EXPECT_NE(page.find("cells end as theory predicts."), std::string::npos);
  EXPECT_EQ(count(page, "<td class=\"v4 odd\""), 0u);
  EXPECT_EQ(page.find("Cells that differ from theory"), std::string::npos);
}
