#include <fmt/format.h>
#include <gtest/gtest.h>

#include <ostream>

#include "stability/lazy_columns.h"
#include "stability/matrix_rows.h"

using namespace palpate;
using namespace palpate::stability;

/// Core of the stability matrix: one sub-case of every row that does not take minutes, over every
/// integrator of the registry.
class CoreOfARow : public testing::TestWithParam<StabilityRow> {};
INSTANTIATE_TEST_SUITE_P(Stability, CoreOfARow, testing::ValuesIn(rows_of_the_matrix(false)), name_of_row);
TEST_P(CoreOfARow, IsAsTheoryExpects) {
  StabilityOptions options;
  options.rows = {GetParam().name};
  options.core = true;
  options.seeds = 1;
  options.jobs = 2;
  const StabilityMatrix matrix = run(options);
  EXPECT_EQ(unexpected_of(matrix), "");
  for (const StabilityCell& cell : matrix.cells) EXPECT_FALSE(cell.expected.empty()) << cell.integrator;
}

class LazyStepper : public testing::TestWithParam<lazy::Named> {};
INSTANTIATE_TEST_SUITE_P(Stability, LazyStepper, testing::ValuesIn(lazy::all()),
                         [](const auto& param) { return param.param.name; });
TEST_P(LazyStepper, SatisfiesNextToNothingOfTheCore) {
  StabilityOptions options;
  options.core = true;
  options.seeds = 1;
  options.jobs = 2;
  EXPECT_LT(lazy::satisfied_share(GetParam(), options), 0.02);
}
