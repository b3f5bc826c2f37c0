#include "shapes/noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shapes/solids.h"

using namespace palpate;

namespace {

TEST(Noise, VanishesOnTheLatticeAndIsBounded) {
  double greatest = 0.0;
  for (int i = -3; i <= 3; ++i)
    for (int j = -3; j <= 3; ++j) EXPECT_EQ(shapes::noise({double(i), double(j), double(i - j)}), 0.0);
  for (int i = 0; i < 4000; ++i)
    greatest = std::max(greatest, std::abs(shapes::noise({0.137 * i, -0.071 * i, 0.0331 * i})));
  EXPECT_GT(greatest, 0.5);
  EXPECT_LT(greatest, 1.2);
}

// Value and slope are continuous across a lattice plane: both one-sided differences agree.
TEST(Noise, IsSmoothAcrossTheLattice) {
  int looked_at = 0;
  for (int i = 0; i < 50; ++i) {
    const Vec3 p(3.0, 0.17 * i, 0.29 * i + 0.05);
    const double h = 1e-5, here = shapes::noise(p), after = shapes::noise(p + Vec3(h, 0, 0)),
                 before = shapes::noise(p - Vec3(h, 0, 0));
    EXPECT_NEAR((after - here) / h, (here - before) / h, 1e-3);
    ++looked_at;
  }
  EXPECT_EQ(looked_at, 50);
}

TEST(Noise, SeedsDiffer) {
  EXPECT_NE(shapes::noise({0.3, 0.4, 0.5}, 1), shapes::noise({0.3, 0.4, 0.5}, 2));
  EXPECT_GE(shapes::chance(7), 0.0);
  EXPECT_LT(shapes::chance(7), 1.0);
}

// join() equals min() where the two differ by at least k, is k/4 below it where they are equal, and is
// symmetric.
TEST(Solids, JoinRoundsTheMinimum) {
  EXPECT_EQ(shapes::join(0.3, 0.1, 0.2), 0.1);
  EXPECT_DOUBLE_EQ(shapes::join(0.1, 0.1, 0.2), 0.1 - 0.05);
  for (int i = 0; i < 100; ++i) {
    const double a = std::sin(1.7 * i), b = std::cos(2.3 * i);
    EXPECT_EQ(shapes::join(a, b, 0.5), shapes::join(b, a, 0.5));
    EXPECT_LE(shapes::join(a, b, 0.5), std::min(a, b));
    EXPECT_GE(shapes::meet(a, b, 0.5), std::max(a, b));
  }
}

// On its surface an ellipsoid is zero, and its slope there is 1: a distance to first order.
TEST(Solids, EllipsoidIsADistanceAtItsSurface) {
  const Vec3 centre(0.1, -0.2, 0.3), radii(0.5, 0.3, 0.8);
  for (int i = 0; i < 40; ++i) {
    const Vec3 u = Vec3(std::sin(1.0 + i), std::cos(2.0 * i), std::sin(3.0 * i + 0.5)).normalized();
    const Vec3 p = centre + u.cwiseProduct(radii), normal = u.cwiseQuotient(radii).normalized();
    EXPECT_NEAR(shapes::ellipsoid(p, centre, radii), 0.0, 1e-12);
    EXPECT_NEAR((shapes::ellipsoid(p + 1e-6 * normal, centre, radii) -
                 shapes::ellipsoid(p - 1e-6 * normal, centre, radii)) /
                    2e-6,
                1.0, 1e-6);
  }
}

// A limb has its full swelling at the prescribed position, and none at its ends.
TEST(Solids, LimbSwellsWhereItIsTold) {
  const Vec3 a(0, 0, 0), b(0, 0, 1);
  for (const double t : {0.0, 0.25, 1.0})
    EXPECT_NEAR(shapes::limb({1, 0, t}, a, b, 0.2, 0.1, 0.05, 0.25),
                1.0 - (0.2 - 0.1 * t) - (t == 0.25 ? 0.05 : 0.0), 1e-12);
}

}  // namespace
