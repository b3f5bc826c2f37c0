#include "proxy/hull_surface.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <random>

using namespace palpate;

namespace {

double volume(const TriMesh& mesh) {
  double sum = 0.0;
  for (const auto f : mesh.faces.colwise())
    sum += mesh.vertices.col(f[0]).dot(mesh.vertices.col(f[1]).cross(mesh.vertices.col(f[2]))) / 6.0;
  return sum;
}

/// Checks that every edge occurs once in each direction: the surface is closed and consistently oriented.
void expect_closed(const TriMesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto f : mesh.faces.colwise())
    for (int k = 0; k < 3; ++k) ++edges[{f[k], f[(k + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
}

}  // namespace

TEST(HullSurface, ABoxHasTwelveTrianglesWhateverLiesOnItsFaces) {
  Points points(3, 8 + 3);
  for (int i = 0; i < 8; ++i) points.col(i) = Vec3(3.0 + (i & 1), 2.0 * (i >> 1 & 1), 0.5 * (i >> 2 & 1));
  points.col(8) = Vec3(3.5, 1.0, 0.25);   // inside
  points.col(9) = Vec3(3.5, 1.0, 0.5);    // in a face
  points.col(10) = Vec3(3.5, 0.0, 0.25);  // in another face
  const TriMesh hull = proxy::hull_surface(points);
  expect_closed(hull);
  EXPECT_NEAR(volume(hull), 1.0, 1e-12);  // outward orientation: positive
}

TEST(HullSurface, BallsConvergeToTheirVolume) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Points points(3, 400);
  for (auto p : points.colwise())
    p = 0.02 * Vec3(normal(random), normal(random), normal(random)).normalized();
  points.colwise() += Vec3(1, -2, 3);
  const TriMesh hull = proxy::hull_surface(points);
  expect_closed(hull);
  EXPECT_EQ(hull.faces.cols(), 2 * 400 - 4);  // Euler: every point is a corner, every face a triangle
  EXPECT_NEAR(volume(hull) / (4.0 / 3.0 * std::numbers::pi * 8e-6), 1.0, 0.05);
}

TEST(HullSurface, AFlatSetHasNoFaces) {
  Points square(3, 4);
  square << 0, 1, 1, 0, 0, 0, 1, 1, 2, 2, 2, 2;
  EXPECT_EQ(proxy::hull_surface(square).faces.cols(), 0);
}
