#include "linear/mixed_precision/lagged_matrix_policy.h"

#include <gtest/gtest.h>

using palpate::linear::LaggedMatrixPolicy;

namespace {
// twice rho of one step of age, times the correction, is a sixth of what may go unseen
constexpr double kRtol = 1e-3, kSize = 1e-2, kRho = 2e-3;

/// Takes steps while the matrix serves, as a solver would; returns how many.
int steps(LaggedMatrixPolicy& age, double size, int most, int* looks = nullptr) {
  int taken = 0;
  for (; taken < most && age.serves(); ++taken) {
    if (!age.sure(size)) {
      if (looks) ++*looks;
      age.seen(kRho * (taken + 1) * size, size);
    }
    age.solved(size);
  }
  return taken;
}
}  // namespace

TEST(LaggedMatrixPolicy, TriesWhereNothingIsKnownAndLooks) {
  LaggedMatrixPolicy age(kRtol);
  age.solved(0.5);  // however large
  EXPECT_TRUE(age.serves());
  EXPECT_FALSE(age.sure(1e-9));
}

// 2 rho n d <= rtol / 4: six steps by one matrix, and looks no more often than the first and by plan.
TEST(LaggedMatrixPolicy, ServesUntilItWouldLeaveTooMuch) {
  LaggedMatrixPolicy age(kRtol);
  int looks = 0;
  EXPECT_EQ(steps(age, kSize, 100, &looks), 6);
  EXPECT_EQ(looks, 1);
  age.renew();
  EXPECT_EQ(steps(age, kSize, 100, &looks), 6) << "what was seen of the last matrix holds for the next";
  EXPECT_EQ(looks, 1);
  age.renew();
  EXPECT_EQ(steps(age, kSize, 100, &looks), 6);
  EXPECT_EQ(looks, 2) << "sixteen steps after the first";
}

TEST(LaggedMatrixPolicy, LooksWhenCorrectionsGrow) {
  LaggedMatrixPolicy age(kRtol);
  ASSERT_EQ(steps(age, 1e-3, 3), 3);
  ASSERT_TRUE(age.serves());
  EXPECT_TRUE(age.sure(2e-3));
  EXPECT_FALSE(age.sure(2.1e-3)) << "it would be small enough, but they were never so large";
  EXPECT_FALSE(age.sure(1.0));
}

TEST(LaggedMatrixPolicy, DoesNotServeWhereOneStepIsTooMuch) {
  LaggedMatrixPolicy age(kRtol);
  ASSERT_TRUE(age.serves());
  age.seen(0.05 * kSize, kSize);
  age.solved(kSize);
  age.renew();
  int refused = 0;
  for (; refused < 1000 && !age.serves(); ++refused) {
    age.renew();
    age.solved(kSize);
  }
  EXPECT_EQ(refused, 63) << "things change: it is tried again";
  EXPECT_FALSE(age.sure(1e-12));
}

TEST(LaggedMatrixPolicy, ServesAgainWhenCorrectionsBecomeSmall) {
  LaggedMatrixPolicy age(kRtol);
  ASSERT_TRUE(age.serves());
  age.seen(0.05 * kSize, kSize);
  age.solved(kSize);
  age.renew();
  EXPECT_FALSE(age.serves());
  age.solved(1e-4);
  EXPECT_TRUE(age.serves());
}

TEST(LaggedMatrixPolicy, RestsAfterAFailure) {
  LaggedMatrixPolicy age(kRtol);
  ASSERT_TRUE(age.serves());
  age.failed();
  age.renew();
  age.solved(kSize);
  EXPECT_FALSE(age.serves());
}

TEST(LaggedMatrixPolicy, RoundingOfAStepsOwnMatrixSaysNothingOfItsAge) {
  LaggedMatrixPolicy age(kRtol);
  ASSERT_TRUE(age.serves());
  age.seen(0.05 * kSize, kSize);
  age.solved(kSize);
  age.renew();
  age.seen(1e-9 * kSize, kSize);
  age.solved(kSize);
  EXPECT_FALSE(age.serves()) << "what is known of age stays";
}

// Two looks in one step: the worse counts.
TEST(LaggedMatrixPolicy, KeepsTheWorstOfAStep) {
  LaggedMatrixPolicy age(kRtol);
  ASSERT_TRUE(age.serves());
  age.seen(4e-3 * kSize, kSize);
  age.seen(1e-3 * 1e-4, 1e-4);
  age.solved(kSize);
  EXPECT_EQ(steps(age, kSize, 100), 2) << "2 x 4e-3 x (1 + 2) x 1e-2 is just below rtol / 4";
}
