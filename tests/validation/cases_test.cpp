#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <set>

#include "palpate/validation/validation.h"

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
  return m.quantity + ": computed " + std::to_string(m.computed) + ", exact " + std::to_string(m.exact) +
         ", error " + std::to_string(m.error) + ", bar " + std::to_string(m.bar) + ", order " +
         std::to_string(m.order) + " in [" + std::to_string(m.order_low) + ", " +
         std::to_string(m.order_high) + "] " + m.note;
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

TEST_P(Case, FailsWhenItsPhysicsIsBroken) {
  ASSERT_FALSE(GetParam().faults.empty()) << "a case that cannot fail is worthless";
  for (const std::string& fault : GetParam().faults) {
    const std::vector<Measurement> measurements = GetParam().run(fault);
    EXPECT_TRUE(std::any_of(measurements.begin(), measurements.end(),
                            [](const Measurement& m) { return !m.passed(); }))
        << "still passes with " << fault
        << (measurements.empty() ? "" : "; first: " + text(measurements.front()));
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
  }
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

TEST(FittedOrder, IsTheSlopeOfAPowerLaw) {
  EXPECT_NEAR(palpate::validation::fitted_order({1, 0.5, 0.25}, {8, 1, 0.125}), 3.0, 1e-12);
}

}  // namespace
