#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "report/run_report.h"
#include "temporary_folder.h"
#include "well_formed.h"

using namespace palpate;

namespace {

std::string page_of(const std::string& cases) {
  const TemporaryFolder dir;
  dir.write("validation.json", R"({"cases": [)" + cases + "]}");
  std::ifstream in(report::write_run_report(dir.path()).page);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string measurement(const std::string& quantity, double error, bool passed) {
  return R"({"quantity": ")" + quantity + R"(", "computed": 1.0, "exact": 1.0, "error": )" +
         std::to_string(error) + R"(, "bar": 0.1, "order": null, "order_low": null, "order_high": null,
           "note": "", "refinement": null, "passed": )" +
         (passed ? "true}" : "false}");
}

std::string one_case(const std::string& name, const std::string& measurements,
                     const std::string& broken = "") {
  return R"({"name": ")" + name + R"(", "section": "C", "summary": "what )" + name +
         R"( measures & <why>", "why": "", "broken": ")" + broken + R"(", "wall_s": 2.5, "measurements": [)" +
         measurements + "]}";
}

std::string between(const std::string& text, const std::string& first, const std::string& last) {
  const std::size_t from = text.find(first);
  if (from == std::string::npos) return {};
  return text.substr(from, text.find(last, from) - from);
}

}  // namespace

TEST(ValidationSection, HasALineACaseAndFoldsItsMeasurementsAway) {
  const std::string page = page_of(one_case(
      "patch", measurement("first stress", 0.02, true) + ", " + measurement("second stress", 0.05, true)));
  EXPECT_EQ(well_formed_problem(page), "");
  const std::string cases = between(page, "Validation against exact solutions", "<details");
  EXPECT_NE(cases.find("what patch measures &amp; &lt;why&gt;"), std::string::npos);
  EXPECT_NE(cases.find("2 of 2"), std::string::npos);
  EXPECT_NE(cases.find(">50<"), std::string::npos) << "0.05 of 0.1";
  EXPECT_NE(cases.find(">pass<"), std::string::npos);
  EXPECT_EQ(cases.find("first stress"), std::string::npos);
  EXPECT_NE(between(page, "<details", "</details>").find("second stress"), std::string::npos);
  EXPECT_EQ(page.find("outside their acceptance limit"), std::string::npos);
}

TEST(ValidationSection, ShowsWhatMissesItsBarAndWhatBroke) {
  const std::string page =
      page_of(one_case("patch", measurement("first stress", 0.02, true) + ", " +
                                    measurement("second stress", 0.3, false)) +
              ", " + one_case("crash", "", "killed by signal 11") + ", " + one_case("idle", ""));
  EXPECT_EQ(well_formed_problem(page), "");
  const std::string shown = between(page, "Validation against exact solutions", "<details");
  EXPECT_NE(shown.find("1 of 2"), std::string::npos);
  EXPECT_NE(shown.find("second stress"), std::string::npos);
  EXPECT_EQ(shown.find("first stress"), std::string::npos);
  EXPECT_NE(shown.find("killed by signal 11"), std::string::npos);
  EXPECT_NE(shown.find("nothing was measured"), std::string::npos);
  EXPECT_EQ(shown.find(">pass<"), std::string::npos);
}
