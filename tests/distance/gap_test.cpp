// Exact distances of triangles and surfaces against known answers and a search through sampled points.
#include "distance/gap.h"

#include <cmath>
#include <limits>

#include "bodies.h"

using namespace distance_tests;

namespace {

/// Points of a triangle on a grid of barycentric weights.
std::vector<Vec3> sampled(const Mat3& triangle, int n) {
  std::vector<Vec3> out;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) out.push_back(triangle * Vec3(i, j, n - i - j) / static_cast<double>(n));
  return out;
}

}  // namespace

TEST(NearestOfTriangles, IsNoFartherThanSampledPointsAndCloseToTheirMinimum) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  int separate = 0, edges = 0;
  for (int i = 0; i < 200; ++i) {
    Mat3 a, b;
    for (Mat3* m : {&a, &b})
      for (double& x : m->reshaped()) x = normal(random);
    b.colwise() += Vec3(i % 4, 0, 0);
    const TrianglePair pair = nearest_of_triangles(a, b);
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& x : sampled(a, 24))
      for (const Vec3& y : sampled(b, 24)) least = std::min(least, (x - y).norm());
    const double distance = std::sqrt(pair.distance2);
    EXPECT_LE(distance, least + 1e-12);
    // a point of a triangle with edges up to 6 lies within 6/24 of a sample, in each of the two
    EXPECT_GE(distance, least - 0.5);
    EXPECT_NEAR((pair.on_first - pair.on_second).norm(), distance, 1e-12);
    if (distance == 0.0) continue;
    ++separate;
    const auto on_edge = [](const Mat3& t, const Vec3& x) {
      const Vec3 w = t.colPivHouseholderQr().solve(x);
      return (w.array().abs() < 1e-9).count() == 1;
    };
    edges += on_edge(a, pair.on_first) && on_edge(b, pair.on_second);
    // no point of either is nearer: the two planes across the connecting line separate the triangles
    const Vec3 way = (pair.on_second - pair.on_first) / distance;
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(way.dot(a.col(k) - pair.on_first), 1e-9);
      EXPECT_GE(way.dot(b.col(k) - pair.on_second), -1e-9);
    }
  }
  EXPECT_GT(separate, 80);
  EXPECT_GT(edges, 10) << "pairs of edges are the case that vertices alone miss";
}

TEST(NearestOfTriangles, CrossingTrianglesHaveNoDistance) {
  Mat3 a, b;
  a << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  b << 0.2, 0.2, 0.2, 0.2, 0.2, 0.9, -1, 1, 1;
  EXPECT_EQ(nearest_of_triangles(a, b).distance2, 0.0);
}

// Two boxes of 0.1 m that are turned by 45 degrees about x and about y: the nearest points lie on two edges
// that cross at a right angle, far from all vertices.
TEST(GapOfSurfaces, OfCrossedEdgesIsExact) {
  RigidSurface first(mesh::box_surface(Vec3::Constant(0.1), {3, 3, 3})),
      second(mesh::box_surface(Vec3::Constant(0.1), {2, 2, 2}));
  const double half_diagonal = 0.05 * std::sqrt(2.0), gap = 0.0123;
  first.move({Quat(Eigen::AngleAxisd(M_PI / 4, Vec3::UnitX())), Vec3::Zero()});
  second.move(
      {Quat(Eigen::AngleAxisd(M_PI / 4, Vec3::UnitY())), Vec3(0.003, 0.004, 2 * half_diagonal + gap)});
  const Gap found = gap_between(first, second);
  EXPECT_NEAR(found.distance, gap, 1e-12);
  EXPECT_NEAR(found.on_first.z(), half_diagonal, 1e-12);
  EXPECT_NEAR(found.on_second.z(), half_diagonal + gap, 1e-12);
  EXPECT_EQ(gap_between(second, first).distance, found.distance);
}

TEST(GapOfSurfaces, IsMinusTheDepthWhereOneIsInTheOther) {
  RigidSurface box(mesh::box_surface(Vec3(0.2, 0.2, 0.1), {4, 4, 2})), ball(mesh::sphere(0.01, 6));
  ball.move({Quat::Identity(), Vec3(0.02, 0.01, 0.03)});
  const Gap inside = gap_between(ball, box);  // its lowest vertex is 0.03 m below the face at 0.05 m
  double deepest = 0.0;
  for (Eigen::Index v = 0; v < ball.vertices().cols(); ++v)
    deepest = std::max(deepest, 0.05 - ball.vertices()(2, v));
  EXPECT_NEAR(inside.distance, -deepest, 1e-12);
  EXPECT_NEAR(inside.on_second.z(), 0.05, 1e-12);
  ball.move({Quat::Identity(), Vec3(0.02, 0.01, 0.0607)});
  EXPECT_GT(gap_between(ball, box).distance, 0.0);
}

TEST(GapOfSurfaces, OfAPointIsSigned) {
  const RigidSurface box(mesh::box_surface(Vec3(0.2, 0.2, 0.1), {4, 4, 2}));
  EXPECT_NEAR(box.from_point(Vec3(0, 0, 0.07)).distance, 0.02, 1e-15);
  EXPECT_NEAR(box.from_point(Vec3(0.01, 0.02, 0.04)).distance, -0.01, 1e-15);
}
