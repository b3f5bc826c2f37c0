// Integrals of the positive part of a linear function over a triangle, against sums over many small ones.
#include "distance/linear_gap.h"

#include "bodies.h"

using namespace distance_tests;

namespace {

/// Integrates by the centroids of n^2 equal triangles.
HatIntegrals summed(const Vec3& overlap, int n) {
  HatIntegrals out;
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j)
      for (int flipped = 0; flipped < (i + j + 1 < n ? 2 : 1); ++flipped) {
        const double third = (1.0 + flipped) / 3.0;
        const Vec3 hats((i + third) / n, (j + third) / n, 1.0 - (i + j + 2.0 * third) / n);
        const double o = hats.dot(overlap);
        if (o <= 0.0) continue;
        out.overlap += o / (n * n) * hats;
        out.area += hats / (n * n);
      }
  return out;
}

}  // namespace

TEST(LinearGap, IntegratesThePositivePart) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  int cases[4] = {};
  for (int i = 0; i < 60; ++i) {
    const Vec3 overlap(normal(random), normal(random), normal(random));
    ++cases[(overlap.array() > 0.0).count()];
    const HatIntegrals exact = integrate_hats(overlap), sum = summed(overlap, 400);
    EXPECT_LT((exact.overlap - sum.overlap).norm(), 2e-5) << overlap.transpose();
    EXPECT_LT((exact.area - sum.area).norm(), 4e-3) << overlap.transpose();
    EXPECT_GE(exact.overlap.minCoeff(), 0.0);
    EXPECT_GE(exact.area.minCoeff(), 0.0);
  }
  for (const int count : cases) EXPECT_GT(count, 3);
}

// The gradient of half the squared overlap with respect to the corner values is the integrated overlap, and
// the derivative of the latter, summed over the corners, is the area.
TEST(LinearGap, IsTheGradientOfHalfTheSquare) {
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  const auto half_square = [](const Vec3& o) { return 0.5 * integrate_hats(o).overlap.dot(o); };
  for (int i = 0; i < 60; ++i) {
    const Vec3 o(normal(random), normal(random), normal(random));
    const HatIntegrals at = integrate_hats(o);
    constexpr double h = 1e-5;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR((half_square(o + h * Vec3::Unit(k)) - half_square(o - h * Vec3::Unit(k))) / (2.0 * h),
                  at.overlap[k], 1e-9);
    const Vec3 slope =
        (integrate_hats(o + Vec3::Constant(h)).overlap - integrate_hats(o - Vec3::Constant(h)).overlap) /
        (2.0 * h);
    EXPECT_LT((slope - at.area).norm(), 1e-4);
  }
}

TEST(LinearGap, TakesCornersOnTheSurfaceItself) {
  for (const Vec3& o : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 1), Vec3(-1, 0, 0), Vec3(-1, 0, 1)}) {
    const HatIntegrals at = integrate_hats(o), sum = summed(o, 400);
    EXPECT_LT((at.overlap - sum.overlap).norm(), 2e-5) << o.transpose();
    EXPECT_LT((at.area - sum.area).norm(), 4e-3) << o.transpose();
  }
  EXPECT_EQ(integrate_hats(Vec3::Zero()).overlap.norm(), 0.0);
}

// On a sphere: the mean of the interpolated distance minus the exact distance, integrated over many points.
TEST(LinearGap, KnowsWhatItMisses) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 5; ++i) {
    Mat3 x, n;
    for (int k = 0; k < 3; ++k) {
      x.col(k) = Vec3(0.05 * normal(random), 0.05 * normal(random), 1.0);
      n.col(k) = x.col(k).normalized();
    }
    const Missed missed = missed_by_linear(x, n);
    double gap = 0.0, length = 0.0;
    constexpr int parts = 200;
    for (int a = 0; a < parts; ++a)
      for (int b = 0; a + b < parts; ++b)
        for (int flipped = 0; flipped < (a + b + 1 < parts ? 2 : 1); ++flipped) {
          const double third = (1.0 + flipped) / 3.0;
          const Vec3 hats((a + third) / parts, (b + third) / parts, 1.0 - (a + b + 2.0 * third) / parts);
          gap += (hats.dot(x.colwise().norm().transpose()) - (x * hats).norm()) / (parts * parts);
          length += (1.0 - (n * hats).norm()) / (parts * parts);
        }
    EXPECT_NEAR(missed.gap / gap, 1.0, 0.03);
    EXPECT_NEAR(missed.normal / length, 1.0, 0.03);
  }
}
