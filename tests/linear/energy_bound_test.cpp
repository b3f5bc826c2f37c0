#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "linear/mixed_precision/energy_bound.h"
#include "palpate/core/types.h"

namespace palpate {
namespace {

// The Gauss-Radau bound against the error itself, along the iteration, for a spectrum given.
TEST(EnergyBound, LiesAboveTheErrorAndCloseToIt) {
  const int n = 60;
  VecX lambda(n);
  for (int i = 0; i < n; ++i) lambda[i] = std::pow(10.0, -2.0 + 2.0 * i / (n - 1));  // 0.01 to 1
  const VecX exact = VecX::LinSpaced(n, 1.0, 2.0), b = lambda.cwiseProduct(exact);
  linear::EnergyBound bound;
  int above = 0, checked = 0;
  double worst = 0.0;
  for (int solve = 0; solve < 3; ++solve) {  // the first teaches it the spectrum
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

}  // namespace
}  // namespace palpate
