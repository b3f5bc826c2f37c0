#include "linear/mixed_precision/lagged_matrix_policy.h"

#include <gtest/gtest.h>

using palpate::linear::LaggedMatrixPolicy;

namespace {
// twice rho for a lag of one step, times the correction, is a sixth of the permitted undetected error
constexpr double kRtol = 1e-3, kSize = 1e-2, kRho = 2e-3;

/// Takes steps as a solver would for as long as the matrix serves; returns their number.
int steps(LaggedMatrixPolicy& policy, double size, int most, int* checks = nullptr) {
  int taken = 0;
  for (; taken < most && policy.serves(); ++taken) {
    if (!policy.sure(size)) {
      if (checks) ++*checks;
      policy.seen(kRho * (taken + 1) * size, size);
    }
    policy.solved(size);
  }
  return taken;
}
}  // namespace

TEST(LaggedMatrixPolicy, TriesWhereNothingIsKnownAndLooks) {
  LaggedMatrixPolicy policy(kRtol);
  policy.solved(0.5);  // correction of any size
  EXPECT_TRUE(policy.serves());
  EXPECT_FALSE(policy.sure(1e-9));
}

// 2 rho n d <= rtol / 4: six steps per matrix, with no checks other than the first and the scheduled ones.
TEST(LaggedMatrixPolicy, ServesUntilItWouldLeaveTooMuch) {
  LaggedMatrixPolicy policy(kRtol);
  int checks = 0;
  EXPECT_EQ(steps(policy, kSize, 100, &checks), 6);
  EXPECT_EQ(checks, 1);
  policy.renew();
  EXPECT_EQ(steps(policy, kSize, 100, &checks), 6) << "what was seen of the last matrix holds for the next";
  EXPECT_EQ(checks, 1);
  policy.renew();
  EXPECT_EQ(steps(policy, kSize, 100, &checks), 6);
  EXPECT_EQ(checks, 2) << "sixteen steps after the first";
}

TEST(LaggedMatrixPolicy, LooksWhenCorrectionsGrow) {
  LaggedMatrixPolicy policy(kRtol);
  ASSERT_EQ(steps(policy, 1e-3, 3), 3);
  ASSERT_TRUE(policy.serves());
  EXPECT_TRUE(policy.sure(2e-3));
  EXPECT_FALSE(policy.sure(2.1e-3)) << "it would be small enough, but they were never so large";
  EXPECT_FALSE(policy.sure(1.0));
}

TEST(LaggedMatrixPolicy, DoesNotServeWhereOneStepIsTooMuch) {
  LaggedMatrixPolicy policy(kRtol);
  ASSERT_TRUE(policy.serves());
  policy.seen(0.05 * kSize, kSize);
  policy.solved(kSize);
  policy.renew();
  int refused = 0;
  for (; refused < 1000 && !policy.serves(); ++refused) {
    policy.renew();
    policy.solved(kSize);
  }
  EXPECT_EQ(refused, 63) << "things change: it is tried again";
  EXPECT_FALSE(policy.sure(1e-12));
}

TEST(LaggedMatrixPolicy, ServesAgainWhenCorrectionsBecomeSmall) {
  LaggedMatrixPolicy policy(kRtol);
  ASSERT_TRUE(policy.serves());
  policy.seen(0.05 * kSize, kSize);
  policy.solved(kSize);
  policy.renew();
  EXPECT_FALSE(policy.serves());
  policy.solved(1e-4);
  EXPECT_TRUE(policy.serves());
}

TEST(LaggedMatrixPolicy, RestsAfterAFailure) {
  LaggedMatrixPolicy policy(kRtol);
  ASSERT_TRUE(policy.serves());
  policy.failed();
  policy.renew();
  policy.solved(kSize);
  EXPECT_FALSE(policy.serves());
}

TEST(LaggedMatrixPolicy, RoundingOfAStepsOwnMatrixSaysNothingOfItsAge) {
  LaggedMatrixPolicy policy(kRtol);
  ASSERT_TRUE(policy.serves());
  policy.seen(0.05 * kSize, kSize);
  policy.solved(kSize);
  policy.renew();
  policy.seen(1e-9 * kSize, kSize);
  policy.solved(kSize);
  EXPECT_FALSE(policy.serves()) << "what is known of the effect of lagging stays";
}

// Two checks in one step: the worse counts.
TEST(LaggedMatrixPolicy, KeepsTheWorstOfAStep) {
  LaggedMatrixPolicy policy(kRtol);
  ASSERT_TRUE(policy.serves());
  policy.seen(4e-3 * kSize, kSize);
  policy.seen(1e-3 * 1e-4, 1e-4);
  policy.solved(kSize);
  EXPECT_EQ(steps(policy, kSize, 100), 2) << "2 x 4e-3 x (1 + 2) x 1e-2 is just below rtol / 4";
}
