#include "core/rounded_range.h"

#include <gtest/gtest.h>

#include <utility>

using namespace palpate;

TEST(RoundedRange, IsTheNextRoundNumber) {
  for (const auto& [x, rounded] :
       {std::pair{1.0, 1.0}, {1.01, 1.2}, {0.0053, 0.006}, {8.1, 10.0}, {99.0, 100.0}, {2.5, 2.5}})
    EXPECT_NEAR(rounded_range(x), rounded, 1e-12 * rounded) << x;
  EXPECT_EQ(rounded_range(0.0), 0.0);
  for (double x = 1e-6; x < 1e6; x *= 1.037) {  // never below the value, never a third above it
    EXPECT_GE(rounded_range(x), x * (1.0 - 1e-9));
    EXPECT_LE(rounded_range(x), x * 1.34);
  }
}
