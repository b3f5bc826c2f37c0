#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "linear/mixed_precision/energy_bound.h"
#include "palpate/core/types.h"

namespace palpate {
namespace {

// The Gauss-Radau bound against the error along the iteration, for a given spectrum.
TEST(EnergyBound, LiesAboveTheErrorAndCloseToIt) {
  const int n = 60;
  VecX lambda(n);
  for (int i = 0; i < n; ++i) lambda[i] = std::pow(10.0, -2.0 + 2.0 * i / (n - 1));  // 0.01 to 1
  const VecX exact = VecX::LinSpaced(n, 1.0, 2.0), b = lambda.cwiseProduct(exact);
  linear::EnergyBound bound;
  int above = 0, checked = 0;
  double worst = 0.0;
  for (int solve = 0; solve < 3; ++solve) {  // the first solve provides the spectrum
    bound.begin(0.0);
    VecX x = VecX::Zero(n), r = b, p = r;
    double rho = r.squaredNorm();
    for (int k = 0; k < 40; ++k) {
      const VecX Ap = lambda.cwiseProduct(p);
      const double alpha = rho / p.dot(Ap);
      x += alpha * p;
      r -= alpha * Ap;
      const double next = r.squaredNorm();
      bound.step(alpha, rho, next);
      p = r + (next / rho) * p;
      rho = next;
      const double error = (exact - x).dot(lambda.cwiseProduct(exact - x));
      if (solve == 0 || error < 1e-20) continue;
      ++checked;
      above += bound.error(rho) >= error * (1.0 - 1e-6);
      worst = std::max(worst, bound.error(rho) / error);
    }
    bound.end();
  }
  EXPECT_GT(checked, 40);
  EXPECT_EQ(above, checked);
  EXPECT_LT(worst, 100.0) << "of the squares: a factor of ten";
}

// Coefficients that no spectrum can produce: the search for a mu below it ends without a bound on the error,
// and the next solve uses the previous estimate.
TEST(EnergyBound, GivesUpWhereNoSpectrumFits) {
  linear::EnergyBound bound, untouched;
  for (linear::EnergyBound* one : {&bound, &untouched}) {
    one->begin(0.0);
    one->step(1.5, 1.0, 0.1);
    one->end();
    one->begin(0.0);
  }
  const std::vector<std::vector<double>> spoilt = {
      {1.0, 1.0, 1e300, 1.0, 1e300, 1e-300, 1.0},  // alpha, rho, next; alpha, rho, next; ...
      {HUGE_VAL, 1.0, 1.0},                        // a step without length
      {1.0, 1.0, std::nan(""), 1.0, 1.0, 1.0}};
  for (const auto& numbers : spoilt) {
    for (std::size_t k = 0; k + 2 < numbers.size(); k += 3)
      bound.step(numbers[k], numbers[k + 1], numbers[k + 2]);
    EXPECT_EQ(bound.error(1.0), HUGE_VAL);
    bound.step(1.0, 1.0, 0.5);
    EXPECT_EQ(bound.error(1.0), HUGE_VAL) << "until the next solve";
    bound.begin(0.0);
    untouched.begin(0.0);
    EXPECT_EQ(bound.error(1.0), untouched.error(1.0));
    EXPECT_LT(bound.error(1.0), HUGE_VAL);
  }
}

}  // namespace
}  // namespace palpate
