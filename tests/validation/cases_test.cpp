#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <ostream>
#include <set>

#include "palpate/core/error.h"
#include "validation.h"

using palpate::validation::Fault;
using palpate::validation::Measurement;
using palpate::validation::validation_cases;
using palpate::validation::ValidationCase;

namespace {

std::vector<ValidationCase> cases(bool slow) {
  std::vector<ValidationCase> out;
  for (const ValidationCase& c : validation_cases())
    if (c.slow == slow) out.push_back(c);
  return out;
}

std::string text(const Measurement& m) {
  return fmt::format(
      "{}: computed {:.10g}, exact {:.10g}, error {:.3g}, bar {:g}, order {:.3f} in [{}, {}] {}", m.quantity,
      m.computed, m.exact, m.error, m.bar, m.order, m.order_low, m.order_high, m.note);
}

}  // namespace

namespace palpate::validation {
void PrintTo(const ValidationCase& c, std::ostream* out) { *out << c.section << " " << c.name; }
}  // namespace palpate::validation

namespace {

class Case : public testing::TestWithParam<ValidationCase> {};

TEST_P(Case, MeetsItsBars) {
  const std::vector<Measurement> measurements = GetParam().run("");
  ASSERT_FALSE(measurements.empty());
  for (const Measurement& m : measurements) EXPECT_TRUE(m.passed()) << text(m);
}

TEST_P(Case, FailsWhenTheLibraryIsBroken) {
  ASSERT_FALSE(GetParam().faults.empty()) << "a case that cannot fail is worthless";
  for (const Fault& fault : GetParam().faults) {
    const std::vector<Measurement> measurements = GetParam().run(fault.name);
    std::string all;
    for (const Measurement& m : measurements)
      if (m.quantity.find(fault.fails) != std::string::npos)
        all += (m.passed() ? "\n  passes: " : "\n  fails: ") + text(m);
    EXPECT_TRUE(fault.is_found(measurements))
        << fault.name << " is not found by \"" << fault.fails << "\":" << all;
  }
}

std::string test_name(const testing::TestParamInfo<ValidationCase>& info) {
  std::string name = info.param.section + "_" + info.param.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return name;
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Case);
INSTANTIATE_TEST_SUITE_P(Validation, Case, testing::ValuesIn(cases(false)), test_name);
INSTANTIATE_TEST_SUITE_P(Slow, Case, testing::ValuesIn(cases(true)), test_name);

TEST(ValidationRegistry, EveryCaseSaysWhatItIsAndHasANameOfItsOwn) {
  std::set<std::string> names;
  for (const ValidationCase& c : validation_cases()) {
    EXPECT_TRUE(names.insert(c.name).second) << c.name << " is listed twice";
    EXPECT_FALSE(c.summary.empty()) << c.name;
    EXPECT_FALSE(c.why.empty()) << c.name;
    EXPECT_NE(c.run, nullptr) << c.name;
    EXPECT_FALSE(c.faults.empty()) << c.name << ": a case that cannot fail is worthless";
  }
}

// `validate --quick` covers each section.
TEST(ValidationRegistry, QuickCasesAreOfEverySectionAndNoneIsSlow) {
  std::map<std::string, std::pair<int, int>> quick_of_all;  // by section
  for (const ValidationCase& one : validation_cases()) {
    EXPECT_FALSE(one.quick && one.slow) << one.name;
    auto& [quick, all] = quick_of_all[one.section];
    quick += one.quick;
    ++all;
  }
  ASSERT_GE(quick_of_all.size(), 4u);  // without tools, section E is absent
  int dear = 0;                        // not quick
  for (const auto& [section, counts] : quick_of_all) {
    EXPECT_GE(counts.first, 4) << section;
    dear += counts.second - counts.first;
  }
  EXPECT_GE(dear, 4);
}

TEST(Measurement, PassesOnlyInsideItsBarAndBand) {
  Measurement m;
  m.error = 0.5;
  m.bar = 1.0;
  EXPECT_TRUE(m.passed());
  m.order = 2.0;
  m.order_low = 1.9;
  m.order_high = 2.1;
  EXPECT_TRUE(m.passed());
  m.order = 2.2;
  EXPECT_FALSE(m.passed());
  m.order = 1.8;
  EXPECT_FALSE(m.passed());
  m.order = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(m.passed()) << "an order that could not be fitted is no order";
  m.order_low = m.order_high = m.order;
  m.error = m.order;
  EXPECT_FALSE(m.passed()) << "a NaN error passes nothing";
}

TEST(Fault, IsFoundByTheMeasurementThatItNamesAlone) {
  Measurement passes, fails;
  passes.quantity = "force [N]";
  fails.quantity = "moment [N m]";
  fails.error = 1.0;
  const std::vector<Measurement> both = {passes, fails};
  EXPECT_TRUE((Fault{"f", "moment"}.is_found(both)));
  EXPECT_FALSE((Fault{"f", "force"}.is_found(both))) << "another one's failure is no find";
  EXPECT_FALSE((Fault{"f", "["}.is_found(both))) << "all that it names must fail";
  EXPECT_FALSE((Fault{"f", "energy"}.is_found(both))) << "nothing of that name was measured";
  EXPECT_FALSE((Fault{"f", ""}.is_found({fails}))) << "it must name one";
}

TEST(FittedOrder, IsTheSlopeOfAPowerLaw) {
  EXPECT_NEAR(palpate::validation::fitted_order({1, 0.5, 0.25}, {8, 1, 0.125}), 3.0, 1e-12);
}

}  // namespace
