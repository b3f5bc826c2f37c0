#include <gtest/gtest.h>

#include "stability/lazy_columns.h"
#include "stability/matrix_rows.h"

using namespace palpate;
using namespace palpate::stability;

/// Each complete row of the stability matrix, over every integrator of the registry.
class WholeRow : public testing::TestWithParam<StabilityRow> {};
INSTANTIATE_TEST_SUITE_P(Stability, WholeRow, testing::ValuesIn(rows_of_the_matrix(true)), name_of_row);
TEST_P(WholeRow, IsAsTheoryExpects) {
  StabilityOptions options;
  options.rows = {GetParam().name};
  options.jobs = 2;
  options.limit_s = GetParam().slow ? 600.0 : 20.0;
  EXPECT_EQ(unexpected_of(run(options)), "");
}

class LazyStepper : public testing::TestWithParam<lazy::Named> {};
INSTANTIATE_TEST_SUITE_P(Stability, LazyStepper, testing::ValuesIn(lazy::all()),
                         [](const auto& param) { return param.param.name; });
TEST_P(LazyStepper, SatisfiesNextToNothing) {
  StabilityOptions options;
  options.jobs = 2;
  EXPECT_LT(lazy::satisfied_share(GetParam(), options), 0.02);
}
/// Uses a few columns, one per way of stepping: a million ticks take their time even if no step does any
/// work.
TEST_P(LazyStepper, SatisfiesNothingOfAMillionTicks) {
  StabilityOptions options;
  options.rows = {"million-ticks"};
  options.integrators = {"linearly-implicit-euler", "rk4", "cvode-bdf", "ark-erk-4"};
  options.jobs = 2;
  options.limit_s = 600.0;
  EXPECT_EQ(lazy::satisfied_share(GetParam(), options), 0.0);
}
