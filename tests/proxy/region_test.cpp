#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "palpate/core/error.h"
#include "palpate/core/pose.h"
#include "proxy/least_width.h"
#include "proxy/region.h"

using namespace palpate;

namespace {

Points box(const Vec3& centre, const Vec3& half, const Quat& rotation = Quat::Identity()) {
  Points p(3, 8);
  for (int i = 0; i < 8; ++i)
    p.col(i) = centre + rotation * Vec3((i & 1 ? 1 : -1) * half.x(), (i & 2 ? 1 : -1) * half.y(),
                                        (i & 4 ? 1 : -1) * half.z());
  return p;
}

/// Uniformly distributed points on a sphere (Fibonacci lattice).
Points sphere(const Vec3& centre, double radius, int count) {
  Points p(3, count);
  const double golden = M_PI * (3 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - 2 * (i + 0.5) / count, r = std::sqrt(1 - z * z);
    p.col(i) = centre + radius * Vec3(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  return p;
}

double brute_depth(const Points& a, const Points& b, const Vec3& n) {
  return (n.transpose() * b).maxCoeff() - (n.transpose() * a).minCoeff();
}

}  // namespace

// Box a overlaps box b by 0.1 at its face along +z: the shortest exit, at any scale and far from the origin.
TEST(Region, BoxesAtEveryScale) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Vec3 far = scale * Vec3(100, -50, 20);
    proxy::RegionFinder finder;
    const auto region = finder.find(box(far + scale * Vec3(0.1, 0.05, 0.9), scale * Vec3(0.4, 0.3, 0.5)),
                                    box(far, scale * Vec3(1, 1, 0.5)), 0.0);
    EXPECT_TRUE(region.found);
    EXPECT_NEAR(region.depth, 0.1 * scale, 1e-6 * scale);
    EXPECT_GT(region.normal.z(), 1 - 1e-8);
    // between 0.4 (a's lowest) and 0.5 (b's highest)
    EXPECT_NEAR((region.origin - far).z(), 0.45 * scale, 1e-6 * scale);
  }
}

// Spheres: the normal lies along the line of centres up to the tessellation; the depth found is at least the
// least depth of the hulls, and at most the depth along the line of centres.
TEST(Region, SpheresAlongRandomDirections) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  int checked = 0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 axis = Vec3(normal(random), normal(random), normal(random)).normalized();
    const double depth = 0.02 + 0.01 * i;  // 0.02 to 0.41 for radii 1 and 0.7
    const Points a = sphere((1.7 - depth) * axis, 0.7, 900), b = sphere(Vec3::Zero(), 1.0, 900);
    proxy::RegionFinder finder;
    const auto region = finder.find(a, b, 0.0);
    EXPECT_TRUE(region.found);
    // the lattice's centroid is slightly off the axis
    EXPECT_LE(region.depth, brute_depth(a, b, axis) + 1e-4);
    EXPECT_NEAR(region.depth, brute_depth(a, b, region.normal), 1e-12);
    // hulls lie inside by up to h^2/8
    EXPECT_NEAR(region.depth, depth, 0.01);
    EXPECT_GT(region.normal.dot(axis), 0.97) << i;
    ++checked;
  }
  EXPECT_EQ(checked, 40);
}

TEST(Region, ApartWithinTheMarginHasADirection) {
  const Vec3 axis = Vec3(1, 2, 2) / 3;
  const Points a = sphere(2.05 * axis, 1.0, 2000), b = sphere(Vec3::Zero(), 1.0, 2000);
  proxy::RegionFinder finder;
  const auto near = finder.find(a, b, 0.1);
  EXPECT_TRUE(near.found);
  EXPECT_LT(near.depth, -0.04);
  EXPECT_GT(near.normal.dot(axis), 0.99);
  EXPECT_FALSE(finder.find(a, b, 0.01).found);
  EXPECT_EQ(finder.counts().apart, 2);
}

// Boxes side by side, long and off-centre: the line of centroids is no separating direction.
TEST(Region, ApartWhereCentroidsMislead) {
  const Points a = box(Vec3(3, 0, 0.25), Vec3(4, 1, 0.1)), b = box(Vec3(-3, 0, 0), Vec3(4, 1, 0.1));
  proxy::RegionFinder finder;
  const auto region = finder.find(a, b, 0.1);
  EXPECT_TRUE(region.found);
  EXPECT_NEAR(region.depth, -0.05, 1e-5);
  EXPECT_NEAR(region.normal.z(), 1.0, 1e-5);
}

/// Depth of two boxes by the separating axis test: face normals and cross products of edges (Gottschalk, Lin
/// and Manocha 1996).
double depth_of_boxes(const Vec3& d, const Vec3& ha, const Quat& ra, const Vec3& hb, const Quat& rb) {
  const Mat3 A = ra.toRotationMatrix(), B = rb.toRotationMatrix();
  double least = std::numeric_limits<double>::infinity();
  const auto offer = [&](const Vec3& axis) {
    if (axis.norm() < 1e-9) return;
    const Vec3 n = axis.normalized();
    const double reach = (A.transpose() * n).cwiseAbs().dot(ha) + (B.transpose() * n).cwiseAbs().dot(hb);
    least = std::min(least, reach - std::abs(n.dot(d)));
  };
  for (int i = 0; i < 3; ++i) {
    offer(A.col(i)), offer(B.col(i));
    for (int j = 0; j < 3; ++j) offer(A.col(i).cross(B.col(j)));
  }
  return least;
}

// EPA's tolerance is a squared length: a value of 1e-6 would let EPA end a thousandth of the size too early.
TEST(Region, EpaIsAsExactAsItsToleranceSays) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> size(0.3, 1.0), shift(-0.6, 0.6);
  const auto any = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  int by_epa = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 ha(size(random), size(random), size(random)), hb(size(random), size(random), size(random)),
        d(shift(random), shift(random), shift(random));
    const Quat ra = quaternion_of(any()), rb = quaternion_of(any());
    proxy::RegionFinder finder;
    const auto region = finder.find(box(d, ha, ra), box(Vec3::Zero(), hb, rb), 0.0);
    const double depth = depth_of_boxes(d, ha, ra, hb, rb);
    if (depth <= 0.0) continue;
    EXPECT_GE(region.depth, depth - 1e-9) << i << ": less than any way out";
    if (region.method != proxy::RegionMethod::kEpa) continue;
    ++by_epa;
    EXPECT_LE(region.depth, depth + 1e-5) << i;
  }
  EXPECT_GT(by_epa, 200);
}

/// Uniformly distributed points on an ellipsoid.
Points ellipsoid(const Vec3& centre, const Vec3& half, const Quat& rotation, int count) {
  const Points p = rotation.toRotationMatrix() * half.asDiagonal() * sphere(Vec3::Zero(), 1.0, count);
  return p.colwise() + centre;
}

// libccd does not bound the iterations of EPA. If it ends early, its direction is verified like any other:
// the depth is the one along the normal found, and at least the least depth.
TEST(Region, WorkOnRoundShapesIsBounded) {
  const Points a = ellipsoid(Vec3(0.1, 0.05, -0.1), Vec3(0.9, 0.4, 0.6), quaternion_of({0.3, 1.0, -0.4}),
                             2000),
               b = ellipsoid(Vec3::Zero(), Vec3(0.5, 1.0, 0.7), Quat::Identity(), 2000);
  proxy::RegionFinder usual;
  const auto found = usual.find(a, b, 0.0);
  EXPECT_EQ(usual.counts().epa, 1) << "MPR alone does not find it";
  EXPECT_EQ(usual.counts().bounded, 0);
  EXPECT_GT(usual.counts().most_supports, 60);
  for (const int most : {0, 10, 40, 60}) {
    proxy::RegionFinder bounded(most);
    const auto region = bounded.find(a, b, 0.0);
    EXPECT_LE(bounded.counts().most_supports, most);
    EXPECT_GE(bounded.counts().bounded, 1) << most;
    EXPECT_NEAR(region.normal.norm(), 1.0, 1e-12) << most;
    EXPECT_NEAR(region.depth, brute_depth(a, b, region.normal), 1e-12) << most;
    EXPECT_GE(region.depth, found.depth - 1e-6) << most;
  }
}

// Touching, flat and degenerate shapes, for which libccd alone returns NaN or zero.
TEST(Region, TouchingFlatAndDegenerateStayFinite) {
  const Points cube = box(Vec3::Zero(), Vec3::Constant(0.5));
  const std::vector<Points> others = {
      box(Vec3(0, 0, 1), Vec3::Constant(0.5)),     // touching faces
      box(Vec3(1, 1, 1), Vec3::Constant(0.5)),     // touching corners
      box(Vec3(0, 0, 0.45), Vec3(0.3, 0.3, 0.0)),  // flat plate inside
      box(Vec3::Zero(), Vec3::Constant(0.5)),      // the same cube
      box(Vec3(0.1, 0, 0.5), Vec3::Zero()),        // one point on a face, eight times
      box(Vec3::Zero(), Vec3::Zero()),             // one point at the centre
  };
  for (std::size_t i = 0; i < others.size(); ++i) {
    proxy::RegionFinder finder;
    const auto region = finder.find(others[i], cube, 1e-6);
    EXPECT_TRUE(region.found) << i;
    EXPECT_TRUE(region.normal.allFinite() && region.origin.allFinite()) << i;
    EXPECT_NEAR(region.normal.norm(), 1.0, 1e-12) << i;
    EXPECT_NEAR(region.depth, brute_depth(others[i], cube, region.normal), 1e-9) << i;
  }
  proxy::RegionFinder finder;
  Points point = Points::Zero(3, 1);
  EXPECT_NEAR(finder.find(point, point, 0.0).normal.norm(), 1.0, 1e-12);
}

// When a box is enclosed, the previous normal keeps its side, although another exit is no longer.
TEST(Region, LastNormalIsACandidate) {
  proxy::RegionFinder finder;
  const Points big = box(Vec3::Zero(), Vec3::Constant(1.0));
  const auto first = finder.find(box(Vec3(0, 0, 1.05), Vec3::Constant(0.1)), big, 0.0);
  EXPECT_GT(first.normal.z(), 0.999);
  const auto deep = finder.find(box(Vec3(0, 0, 0.3), Vec3::Constant(0.1)), big, 0.0);
  EXPECT_NEAR(deep.depth, 0.8, 1e-6);  // 1 - 0.3 + 0.1
  EXPECT_GT(deep.normal.z(), 0.999);
  EXPECT_EQ(finder.counts().queries, 2);
}

// A plate in any orientation has its thickness as width, a ball its diameter, a tetrahedron with edge a the
// distance of two opposite edges, a / sqrt(2).
TEST(LeastWidth, IsThatOfKnownShapes) {
  Points tetrahedron(3, 4);
  tetrahedron << 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1, 1;
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 40; ++i) {
    const Quat turn = quaternion_of(2.0 * Vec3(normal(random), normal(random), normal(random)));
    EXPECT_NEAR(proxy::least_width(box(Vec3(3, 1, -2), Vec3(1.0, 0.7, 0.01), turn)), 0.02, 2e-4) << i;
    EXPECT_NEAR(proxy::least_width(turn.toRotationMatrix() * tetrahedron), 2.0, 1e-3) << i;
  }
  EXPECT_NEAR(proxy::least_width(sphere(Vec3(1, 2, 3), 0.5, 2000)), 1.0, 0.01);
  EXPECT_EQ(proxy::least_width(Points(Vec3(1, 2, 3))), 0.0);
}

TEST(Region, EmptyAndNonFinitePointsAreRefused) {
  proxy::RegionFinder finder;
  const Points cube = box(Vec3::Zero(), Vec3::Constant(0.5));
  EXPECT_THROW(finder.find(Points(3, 0), cube, 0.0), InternalError);
  Points bad = cube;
  bad(1, 3) = std::numeric_limits<double>::quiet_NaN();
  try {
    finder.find(cube, bad, 0.0);
    FAIL();
  } catch (const InternalError& e) {
    EXPECT_NE(std::string(e.what()).find("second body is not finite"), std::string::npos) << e.what();
  }
}
