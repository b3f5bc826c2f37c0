#include "model/bind.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

using namespace palpate;

namespace {

/// Definition: the least distance to any ball of the bone.
double by_search(const Bone& bone, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 100000; ++i) {
    const double t = i / 1e5;
    least = std::min(least, (p - bone.head - t * (bone.tail - bone.head)).norm() - bone.head_radius -
                                t * (bone.tail_radius - bone.head_radius));
  }
  return least;
}

TEST(Bind, DistanceIsTheLeastToAnyBall) {
  const std::vector<Bone> bones = {{"capsule", -1, {0, 0, 0}, {1, 0, 0}, 0.3, 0.3},
                                   {"cone", -1, {0.1, 0.2, 0}, {1, -1, 2}, 0.1, 0.6},
                                   {"other way", -1, {0, 0, 0}, {0, 0, 1}, 0.5, 0.05},
                                   {"one ball holds the other", -1, {0, 0, 0}, {0.1, 0, 0}, 0.2, 0.5},
                                   {"ball", -1, {1, 1, 1}, {1, 1, 1}, 0.2, 0.2}};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-2, 2);
  for (const Bone& bone : bones)
    for (int i = 0; i < 30; ++i) {
      const Vec3 p(place(random), place(random), place(random));
      EXPECT_NEAR(model::distance_to_bone(bone, p), by_search(bone, p), 1e-8)
          << bone.name << " " << p.transpose();
    }
}

TEST(Bind, NodesGoToTheBoneThatHoldsThemMost) {
  Skeleton skeleton;
  skeleton.bones = {{"left", -1, {-1, 0, 0}, {0, 0, 0}, 0.2, 0.2},
                    {"right", 0, {0, 0, 0}, {1, 0, 0}, 0.2, 0.2}};
  const Points nodes =
      (Points(3, 5) << -0.5, 0.5, 0.5, 0.5, 3, 0, 0, 0.19, 0.25, 0, 0, 0, 0, 0, 0).finished();
  EXPECT_EQ(model::bind_nodes(nodes, skeleton), (std::vector<int>{0, 1, 1, -1, -1}));
  EXPECT_EQ(model::bind_nodes(nodes, skeleton, 0.1), (std::vector<int>{0, 1, 1, 1, -1}));
}

TEST(Bind, AThinBoneTakesItsNearestNode) {
  Skeleton skeleton;
  skeleton.bones = {{"thick", -1, {0, 0, 0}, {1, 0, 0}, 0.3, 0.3},
                    {"thin", 0, {2, 0.1, 0}, {3, 0.1, 0}, 0.01, 0.01}};
  const Points nodes = (Points(3, 4) << 0.5, 2.5, 2.5, 0.4, 0, 0, 1, 0, 0, 0, 0, 0).finished();
  EXPECT_EQ(model::bind_nodes(nodes, skeleton), (std::vector<int>{0, 1, -1, 0}));
  EXPECT_EQ(model::bind_nodes(nodes, Skeleton{}), (std::vector<int>{-1, -1, -1, -1}));
}

}  // namespace
