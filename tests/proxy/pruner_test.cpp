#include "proxy/pruner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "palpate/core/error.h"
#include "pruning.h"
#include "shapes.h"

using namespace palpate;
using proxy::ProxySet;
using proxy::Pruner;
using namespace pruning;

namespace {

Pose random_pose(std::mt19937& random, double distance) {
  std::normal_distribution<double> normal;
  const Quat q = Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
  return {q, distance * Vec3(normal(random), normal(random), normal(random)).normalized()};
}

}  // namespace

// Reference: all vertices of each body against all faces of the other. Random poses from separate to
// enclosed, with waves through both bodies: no face with a vertex inside the other body is missing, and every
// face of a occurs once.
TEST(Pruner, NothingTrulyOverlappingIsMissed) {
  const LayeredModel ball = cut(bumpy_ball(1.0, 0.3, 9), 20),
                     small = cut(bumpy_ball(0.5, 0.2, 7, 0.1, 5), 12);
  Placed a(ball), b(small);
  Pruner pruner(a.set, b.set);
  std::mt19937 random(5);
  int overlapping = 0, apart = 0, enclosed = 0, regions_seen = 0;
  for (unsigned i = 0; i < 40; ++i) {
    a.place(random_pose(random, 0.0), i % 3 * 0.05, 2 * i);
    b.place(random_pose(random, 0.1 + 0.045 * i), i % 2 * 0.04, 2 * i + 1);
    const auto regions = pruner.query(0.0);
    regions_seen += static_cast<int>(regions.size());
    const Handed found = handed(regions);
    EXPECT_FALSE(found.a_twice) << i;
    const auto b_in_a = inside(b.skin, ball.skin.faces, a.skin);
    const auto faces_a = true_patch(ball.skin.faces, a.skin, small.skin.faces, b.skin),
               faces_b = faces_at(small.skin.faces, b_in_a);
    EXPECT_TRUE(holds(found.a, faces_a)) << i;
    EXPECT_TRUE(holds(found.b, faces_b)) << i;
    for (const auto& region : regions) {
      EXPECT_NEAR(region.region.normal.norm(), 1.0, 1e-12);
      EXPECT_NEAR((region.axes.transpose() * region.axes - Mat3::Identity()).norm(), 0.0, 1e-12);
      EXPECT_NEAR((region.axes.col(2) - region.region.normal).norm(), 0.0, 1e-15);
      if (!faces_b.empty() && faces_a.empty()) {
        EXPECT_FALSE(region.faces_a.empty() && region.faces_b.empty());
      }
    }
    const bool all_in = std::count(b_in_a.begin(), b_in_a.end(), 1) == static_cast<long>(b_in_a.size());
    ++(faces_a.empty() && faces_b.empty() ? apart : all_in ? enclosed : overlapping);
  }
  EXPECT_GT(overlapping, 8);
  EXPECT_GT(apart, 4);
  EXPECT_GT(enclosed, 4);
  EXPECT_GT(regions_seen, 20);
  EXPECT_EQ(pruner.counts().queries, 40);
  EXPECT_EQ(pruner.counts().after_boxes,
            pruner.counts().apart_by_memory + pruner.counts().apart_by_search + pruner.counts().after_hulls);
}

// Points within the gap count as touching: brute force over the vertices and the other side's face corners.
TEST(Pruner, TheGapIsHonoured) {
  const LayeredModel ball = cut(bumpy_ball(1.0, 0.3, 12), 20);
  Placed a(ball), b(ball);
  const double gap = 0.1;
  b.place({Quat::Identity(), Vec3(0, 0, -2.04)}, 0.0, 0);
  Pruner pruner(a.set, b.set);
  const Handed found = handed(pruner.query(gap));
  int near = 0;
  for (Eigen::Index f = 0; f < ball.skin.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k)
      if ((b.skin.colwise() - a.skin.col(ball.skin.faces(k, f))).colwise().norm().minCoeff() < gap) {
        EXPECT_TRUE(found.a.contains(static_cast<int>(f)));
        ++near;
      }
  EXPECT_GT(near, 3);
  EXPECT_TRUE(pruner.query(0.0).empty() || handed(pruner.query(0.0)).a.size() < found.a.size());
}

// One pose, with the body cut into 1, 8 and 64 proxies: the same faces in contact, each once; one region
// whose normal is the line of centres.
TEST(Pruner, TheCutDoesNotChangeWhatTouches) {
  const LayeredModel whole = bumpy_ball(1.0, 0.2, 20, 0.0);
  const Vec3 axis = Vec3(1, 2, -2) / 3;
  for (const int count : {1, 8, 64}) {
    const LayeredModel model = cut(whole, count);
    Placed a(model), b(model);
    b.place({Quat(Eigen::AngleAxisd(1.0, Vec3::UnitY())), -1.94 * axis}, 0.0, 0);
    Pruner pruner(a.set, b.set);
    const auto regions = pruner.query(0.0);
    ASSERT_EQ(regions.size(), 1u) << count;
    // libccd on the hulls alone has errors of 0.27, 0.03 and 0.02 here
    EXPECT_GT(regions[0].region.normal.dot(axis), std::cos(0.04)) << count;
    const Handed found = handed(regions);
    EXPECT_FALSE(found.a_twice);
    const auto faces_a = true_patch(model.skin.faces, a.skin, model.skin.faces, b.skin),
               faces_b = true_patch(model.skin.faces, b.skin, model.skin.faces, a.skin);
    EXPECT_GT(faces_a.size(), 20u);
    EXPECT_TRUE(holds(found.a, faces_a));
    EXPECT_TRUE(holds(found.b, faces_b));
    const std::string name = std::to_string(count) + "_proxies_";
    RecordProperty(name + "normal_off_mrad",
                   static_cast<int>(1e3 * std::acos(std::min(1.0, regions[0].region.normal.dot(axis)))));
    RecordProperty(name + "faces_per_true_percent", static_cast<int>(100 * found.a.size() / faces_a.size()));
  }
}

// Faces passed on: at most 2 x the true patch's share + 3 % of the skin, with 60 proxies per body.
TEST(Pruner, HandsOnLittleMoreThanThePatch) {
  const LayeredModel pumpkin = cut(bumpy_ball(1.0, 0.2, 20, 0.05, 8), 60);
  Placed a(pumpkin), b(pumpkin);
  Pruner pruner(a.set, b.set);
  int checked = 0;
  for (const double distance : {1.98, 1.9, 1.8, 1.6}) {
    b.place({Quat(Eigen::AngleAxisd(0.3, Vec3::UnitX())), distance * Vec3(1, 0.3, 0.2).normalized()}, 0.03,
            1);
    const Handed found = handed(pruner.query(0.0));
    const auto share = [&](const auto& faces) {
      return static_cast<double>(faces.size()) / static_cast<double>(pumpkin.skin.faces.cols());
    };
    const double reference_a = share(true_patch(pumpkin.skin.faces, a.skin, pumpkin.skin.faces, b.skin));
    const double reference_b = share(true_patch(pumpkin.skin.faces, b.skin, pumpkin.skin.faces, a.skin));
    EXPECT_LE(share(found.a), 2 * reference_a + 0.03) << distance;
    EXPECT_LE(share(found.b), 2 * reference_b + 0.03) << distance;
    checked += reference_a > 0.0;
  }
  EXPECT_GE(checked, 3);
}

// A block pressed into the inner corner of two walls has one region per wall, with that wall's normal;
// against one wall, one region.
TEST(Pruner, WallsThatFaceDifferentWaysAreDifferentRegions) {
  LayeredModel wall;  // rigid: two thick slabs that form an L
  const auto slab = [](const Vec3& centre, const Vec3& size) {
    TriMesh s = mesh::box_surface(size, {6, 6, 6});
    s.vertices.colwise() += centre;
    return s;
  };
  const TriMesh floor = slab(Vec3(0, 0, -0.5), Vec3(4, 4, 1)), side = slab(Vec3(-2.5, 0, 1), Vec3(1, 4, 4));
  const Eigen::Index n = floor.vertices.cols();
  wall.skin.vertices.resize(3, 2 * n);
  wall.skin.vertices << floor.vertices, side.vertices;
  wall.skin.faces.resize(3, 2 * floor.faces.cols());
  wall.skin.faces << floor.faces, (side.faces.array() + static_cast<int>(n)).matrix();
  for (const TriMesh* s : {&floor, &side}) {
    ProxyHull hull;
    hull.corners.resize(3, 8);
    const Vec3 low = s->vertices.rowwise().minCoeff(), high = s->vertices.rowwise().maxCoeff();
    for (int i = 0; i < 8; ++i)
      hull.corners.col(i) =
          Vec3(i & 1 ? low.x() : high.x(), i & 2 ? low.y() : high.y(), i & 4 ? low.z() : high.z());
    for (int v = 0; v < n; ++v) hull.members.push_back(v + (s == &side ? static_cast<int>(n) : 0));
    wall.proxies.push_back(hull);
  }
  ProxySet walls(wall);
  LayeredModel block;
  block.tets = mesh::box(Vec3(1, 1, 1), {3, 3, 3});
  block.skin = mesh::box_surface(Vec3(1, 1, 1), {12, 12, 12});
  block.embedding = mesh::embed(block.tets, block.skin.vertices);
  block = cut(block, 24);
  Placed a(block);
  Pruner pruner(a.set, walls);
  const auto place = [&](const Vec3& at) {
    a.place({Quat::Identity(), at}, 0.0, 0);
    return pruner.query(0.0);
  };
  auto regions = place(Vec3(0, 0, 0.48));
  ASSERT_EQ(regions.size(), 1u);
  EXPECT_GT(regions[0].region.normal.z(), 0.999);
  EXPECT_NEAR(regions[0].region.depth, 0.02, 1e-6);
  EXPECT_EQ(regions[0].rotation, 0.0);
  regions = place(Vec3(0.1, 0, 0.49));
  ASSERT_EQ(regions.size(), 1u);
  EXPECT_LT(regions[0].rotation, 1e-6);
  regions = place(Vec3(-1.52, 0, 1.5));
  ASSERT_EQ(regions.size(), 1u);
  EXPECT_GT(regions[0].region.normal.x(), 0.999);
  regions = place(Vec3(-1.52, 0, 0.48));
  double most_x = 0, most_z = 0;
  for (const auto& region : regions) {
    most_x = std::max(most_x, region.region.normal.x());
    most_z = std::max(most_z, region.region.normal.z());
  }
  EXPECT_GE(regions.size(), 2u);
  EXPECT_GT(most_x, 0.95);
  EXPECT_GT(most_z, 0.95);
  EXPECT_FALSE(handed(regions).a_twice);
}

// One ball slides around the other, a hundredth of a radian per step, across the borders of many proxies: the
// normal follows the line of centres, with small jumps as patches are added and removed. The recorded
// rotation is consistent: the largest `rotation` of a region is `largest_rotation`.
TEST(Pruner, SlidingOverProxiesTurnsTheNormalSmoothly) {
  const LayeredModel ball = cut(bumpy_ball(1.0, 0.25, 24, 0.0), 60);
  Placed a(ball), b(ball);
  Pruner pruner(a.set, b.set);
  double largest = 0.0, off = 0.0;
  std::set<int> proxies;
  for (int i = 0; i < 60; ++i) {
    const double angle = 0.01 * i;
    const Vec3 axis(std::cos(angle), std::sin(angle), 0.0);
    b.place({Quat::Identity(), -1.95 * axis}, 0.0, 0);
    const auto regions = pruner.query(0.0);
    ASSERT_EQ(regions.size(), 1u) << i;
    largest = std::max(largest, regions[0].rotation);
    off = std::max(off, std::acos(std::min(1.0, regions[0].region.normal.dot(axis))));
    for (const auto& pair : regions[0].pairs) proxies.insert(pair.first);
  }
  EXPECT_GT(proxies.size(), 4u);
  EXPECT_EQ(largest, pruner.counts().largest_rotation);
  EXPECT_LT(off, 0.05);
  EXPECT_LT(largest, 0.05);  // 0.01 is due to the motion
  RecordProperty("largest_turn_mrad", static_cast<int>(1e3 * largest));
  RecordProperty("off_mrad", static_cast<int>(1e3 * off));
}

// A ball enclosed by a larger one is in contact with the skin above it, through which it was pushed.
TEST(Pruner, SwallowedSkinLooksThroughItself) {
  const LayeredModel big = cut(bumpy_ball(1.0, 0.25, 16, 0.0), 30),
                     small = cut(bumpy_ball(0.15, 0.08, 6, 0.0), 6);
  Placed a(small), b(big);
  Pruner pruner(a.set, b.set);
  for (const double z : {1.2, 1.1, 1.0, 0.9, 0.8, 0.7}) {
    a.place({Quat::Identity(), Vec3(0, 0, z)}, 0.0, 0);
    const auto regions = pruner.query(0.01);
    if (z > 1.16) continue;
    ASSERT_GE(regions.size(), 1u) << z;
    std::set<int> above;  // b's upward faces above the ball's centre, along the normal
    bool seen = false;
    for (const auto& region : regions) {
      EXPECT_GT(region.region.normal.z(), 0.8) << z;
      for (const int f : region.faces_b) {
        const Vec3 middle = (b.skin.col(big.skin.faces(0, f)) + b.skin.col(big.skin.faces(1, f)) +
                             b.skin.col(big.skin.faces(2, f))) /
                            3.0;
        seen |= middle.z() > 0.95 && middle.head<2>().norm() < 0.15;
      }
      EXPECT_FALSE(region.faces_a.empty());
    }
    EXPECT_TRUE(seen) << z;
  }
}

TEST(Pruner, RefusesBadArguments) {
  const LayeredModel ball = cut(bumpy_ball(1.0, 0.4, 6), 4);
  ProxySet set(ball);
  EXPECT_THROW(Pruner(set, set, {.merge_angle_rad = -1}), Error);
  Pruner pruner(set, set);
  EXPECT_THROW(pruner.query(-1.0), InternalError);
}
