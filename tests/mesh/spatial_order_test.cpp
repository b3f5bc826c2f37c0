#include "mesh/spatial_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "palpate/mesh/generators.h"

namespace palpate {
namespace {

std::vector<int> shuffled(int count, unsigned seed) {
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return order;
}

TEST(SpatialOrder, HoldsEachPointOnce) {
  const Points points = Points::Random(3, 1001);
  std::vector<int> order = mesh::spatial_order(points);
  std::sort(order.begin(), order.end());
  for (int k = 0; k < 1001; ++k) ASSERT_EQ(order[static_cast<std::size_t>(k)], k);
  EXPECT_TRUE(mesh::spatial_order(Points(3, 0)).empty());
}

TEST(SpatialOrder, PutsTheSamePointsInTheSameOrder) {
  const TetMesh box = mesh::box(Vec3::Constant(1.0), {7, 7, 7});  // many nodes in one plane
  const auto count = static_cast<int>(box.nodes.cols());
  std::vector<int> order = shuffled(count, 3);
  mesh::spatial_order(box.nodes, order, 0, count);
  EXPECT_EQ(order, mesh::spatial_order(box.nodes));
}

TEST(SpatialOrder, KeepsTheRestOfTheList) {
  const Points points = Points::Random(3, 100);
  std::vector<int> order = shuffled(100, 1);
  const std::vector<int> before = order;
  mesh::spatial_order(points, order, 30, 70);
  EXPECT_TRUE(std::equal(order.begin(), order.begin() + 30, before.begin()));
  EXPECT_TRUE(std::equal(order.begin() + 70, order.end(), before.begin() + 70));
  EXPECT_TRUE(std::is_permutation(order.begin() + 30, order.begin() + 70, before.begin() + 30));
  EXPECT_FALSE(std::equal(order.begin(), order.end(), before.begin()));
}

TEST(SpatialOrder, CutsAcrossTheLongestSide) {
  const Points points = Vec3(1.0, 3.0, 2.0).asDiagonal() * Points::Random(3, 200);
  std::vector<int> order = shuffled(200, 2);
  mesh::cut_across_longest(points, order, 0, 200, 80);
  double below = -1e300, above = 1e300;
  for (std::size_t k = 0; k < 200; ++k) {
    const double y = points(1, order[k]);
    if (k < 80)
      below = std::max(below, y);
    else
      above = std::min(above, y);
  }
  EXPECT_LT(below, above);
}

TEST(SpatialOrder, RenumberedMeshIsTheSameMesh) {
  const TetMesh before = mesh::perturbed(mesh::box(Vec3(1.0, 0.5, 0.25), {6, 3, 2}), 0.1, 5);
  TetMesh after = before;
  const std::vector<int> order = mesh::spatial_order(before.nodes);
  mesh::renumber_nodes(after, order);
  ASSERT_EQ(after.nodes.cols(), before.nodes.cols());
  for (std::size_t k = 0; k < order.size(); ++k)
    ASSERT_EQ(Vec3(after.nodes.col(static_cast<Eigen::Index>(k))), Vec3(before.nodes.col(order[k])));
  for (Eigen::Index t = 0; t < before.tets.cols(); ++t)
    for (int corner = 0; corner < 4; ++corner)
      ASSERT_EQ(Vec3(after.nodes.col(after.tets(corner, t))), Vec3(before.nodes.col(before.tets(corner, t))));
  EXPECT_NE(after.tets, before.tets);
}

/// Number of runs of consecutive numbers among the points in a ball.
int runs_in_ball(const Points& points, const std::vector<int>& order, double radius, int* in_ball) {
  int runs = 0;
  bool before = false;
  *in_ball = 0;
  for (const int point : order) {
    const bool inside = points.col(point).norm() < radius;
    runs += inside && !before;
    *in_ball += inside;
    before = inside;
  }
  return runs;
}

// Only the points at the surface of a compact part, about 4 n^(2/3) of n in a ball, can begin a run of
// consecutive numbers; in a mesher's order nearly every point does.
TEST(SpatialOrder, ACompactPartLiesInRunsThatNumberLikeItsSurface) {
  const Points points = Points::Random(3, 200000);
  const std::vector<int> mesher = shuffled(200000, 7), spatial = mesh::spatial_order(points);
  std::vector<double> size, count;
  for (const double radius : {0.15, 0.3, 0.6}) {
    int n = 0;
    const int runs = runs_in_ball(points, spatial, radius, &n),
              scattered = runs_in_ball(points, mesher, radius, &n);
    EXPECT_LT(runs, 2.0 * std::pow(n, 2.0 / 3.0)) << n << " points";
    EXPECT_GT(scattered, 0.8 * n);
    size.push_back(std::log(n));
    count.push_back(std::log(runs));
  }
  EXPECT_NEAR((count[2] - count[0]) / (size[2] - size[0]), 2.0 / 3.0, 0.1);
}

}  // namespace
}  // namespace palpate
