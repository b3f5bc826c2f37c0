#include <gtest/gtest.h>

#include <ostream>

#include "palpate/core/error.h"
#include "palpate/stability/stability.h"

namespace palpate::stability {
void PrintTo(const StabilityRow& row, std::ostream* out) { *out << row.name; }
}  // namespace palpate::stability

using namespace palpate;
using namespace palpate::stability;

/// Each row of the stability matrix, whole, over every integrator of the registry.
class WholeRow : public testing::TestWithParam<StabilityRow> {};
INSTANTIATE_TEST_SUITE_P(Stability, WholeRow, testing::ValuesIn(stability_rows()), [](const auto& param) {
  std::string name = param.param.name;
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
});
TEST_P(WholeRow, IsAsTheoryExpects) {
  StabilityOptions options;
  options.rows = {GetParam().name};
  options.jobs = 2;
  options.limit_s = GetParam().slow ? 600.0 : 20.0;
  std::string unexpected;
  for (const StabilityCell& c : run(options).cells)
    if (!c.as_expected())
      unexpected += fmt::format("{} / {}: {}, expected {}; {}; {}\n", c.sub_case, c.integrator,
                                to_string(c.verdict), c.expected.text(), c.figure, c.reason);
  EXPECT_EQ(unexpected, "");
}
