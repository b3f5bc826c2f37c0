// Order and limit of values on a sequence of meshes.
#include "experiments/compare/grid_convergence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/core/error.h"

using namespace palpate;
using compare::Convergence;
using compare::GridEstimate;

namespace {

/// Values f + c h^p on meshes of these sizes.
std::vector<double> values_of(const std::vector<double>& sizes, double limit, double c, double p) {
  std::vector<double> out;
  for (const double h : sizes) out.push_back(limit + c * std::pow(h, p));
  return out;
}

TEST(GridConvergence, OrderAndLimitOfAPowerAreExact) {
  for (const std::vector<double>& sizes : {std::vector{1.0, 0.5, 0.25}, {1.0, 0.7, 0.4}, {3.0, 2.0, 1.9}})
    for (const double p : {1.0, 1.5, 2.0})
      for (const double c : {0.3, -0.3}) {
        const GridEstimate e = compare::estimate(sizes, values_of(sizes, 2.0, c, p));
        EXPECT_EQ(e.kind, Convergence::kAsymptotic);
        EXPECT_NEAR(e.order, p, 1e-6);
        EXPECT_NEAR(e.value, 2.0, 1e-7);
        // F |f1 - f|
        EXPECT_NEAR(e.uncertainty, 1.25 * 0.3 * std::pow(sizes.back(), p), 1e-6);
      }
}

TEST(GridConvergence, TheFinestThreeLevelsCount) {
  std::vector<double> values = values_of({0.5, 0.25, 0.125}, 2.0, 0.3, 2.0);
  values.insert(values.begin(), -17.0);
  const GridEstimate e = compare::estimate({1.0, 0.5, 0.25, 0.125}, values);
  EXPECT_NEAR(e.order, 2.0, 1e-6);
}

TEST(GridConvergence, TheIntervalContainsTheLimitWithATermOfHigherOrder) {
  // f = 1 + h^p (1 + h): the observed order differs from p.
  for (const double p : {1.0, 1.5, 2.0}) {
    std::vector<double> values;
    const std::vector<double> sizes = {0.8, 0.4, 0.2};
    for (const double h : sizes) values.push_back(1.0 + std::pow(h, p) * (1.0 + h));
    const GridEstimate e = compare::estimate(sizes, values);
    EXPECT_NE(e.kind, Convergence::kOscillating);
    EXPECT_LE(std::abs(e.value - 1.0), e.uncertainty) << p;
    EXPECT_GT(std::abs(e.value - 1.0), 1e-4) << p;  // the extrapolation alone is not the limit
  }
}

TEST(GridConvergence, AnOrderOutsideTheAsymptoticRangeIsLimitedAndTheFactorIsThree) {
  const std::vector<double> sizes = {1.0, 0.5, 0.25};
  const GridEstimate fast = compare::estimate(sizes, values_of(sizes, 1.0, 0.1, 4.0));
  EXPECT_EQ(fast.kind, Convergence::kMonotone);
  EXPECT_NEAR(fast.order, 4.0, 1e-6);
  const double difference = 0.1 * (std::pow(0.5, 4) - std::pow(0.25, 4));
  EXPECT_NEAR(fast.uncertainty, 3.0 * difference / 3.0, 1e-9);  // order 2: 2^2 - 1 = 3
  const GridEstimate slow = compare::estimate(sizes, values_of(sizes, 1.0, 0.1, 0.2));
  EXPECT_EQ(slow.kind, Convergence::kMonotone);
  EXPECT_NEAR(slow.order, 0.2, 1e-6);
}

TEST(GridConvergence, OscillationAndDivergenceHaveNoOrderAndNoExtrapolation) {
  const GridEstimate waves = compare::estimate({1.0, 0.5, 0.25}, {1.0, 1.3, 1.1});
  EXPECT_EQ(waves.kind, Convergence::kOscillating);
  EXPECT_TRUE(std::isnan(waves.order));
  EXPECT_EQ(waves.value, 1.1);
  EXPECT_NEAR(waves.uncertainty, 3.0 * 0.3, 1e-12);
  const GridEstimate grows = compare::estimate({1.0, 0.5, 0.25}, {1.0, 1.1, 1.3});
  EXPECT_EQ(grows.kind, Convergence::kDiverging);
  EXPECT_EQ(grows.value, 1.3);
  // Equal differences at a ratio of two are of order zero.
  EXPECT_EQ(compare::estimate({1.0, 0.5, 0.25}, {1.0, 1.1, 1.2}).kind, Convergence::kDiverging);
}

TEST(GridConvergence, EqualLevelsAreReportedAsARefinementWithoutEffect) {
  EXPECT_EQ(compare::estimate({1.0, 0.5, 0.25}, {1.0, 1.0, 1.0}).kind, Convergence::kEqual);
  EXPECT_EQ(compare::estimate({1.0, 0.5}, {1.0, 1.0 + 1e-15}).kind, Convergence::kEqual);
  // Sizes that do not fall: the mesh was not refined.
  EXPECT_EQ(compare::estimate({1.0, 1.0}, {1.0, 1.1}).kind, Convergence::kEqual);
  EXPECT_NE(compare::estimate({1.0, 0.5}, {1.0, 1.0 + 1e-9}).kind, Convergence::kEqual);
}

TEST(GridConvergence, TwoLevelsHaveAnAssumedOrderAndOneHasNoEstimate) {
  const GridEstimate two = compare::estimate({1.0, 0.5}, {1.2, 1.1});
  EXPECT_EQ(two.kind, Convergence::kTwoLevels);
  EXPECT_NEAR(two.value, 1.0, 1e-12);  // order 1
  EXPECT_NEAR(two.uncertainty, 0.3, 1e-12);
  EXPECT_EQ(compare::estimate({1.0}, {1.2}).kind, Convergence::kTooFew);
  EXPECT_THROW(compare::estimate({1.0, 0.5}, {1.2}), InternalError);
}

}  // namespace
