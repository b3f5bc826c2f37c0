#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "shapes/figure.h"
#include "shapes/human.h"

using namespace palpate;

namespace {

const std::vector<Bone>& bones() {
  static const Skeleton skeleton = shapes::figure::skeleton();
  return skeleton.bones;
}

TEST(HumanSkeleton, HasItsBonesParentsFirst) {
  ASSERT_GE(bones().size(), 17U);
  std::set<std::string> names;
  for (int b = 0; b < static_cast<int>(bones().size()); ++b) {
    EXPECT_TRUE(names.insert(bones()[b].name).second);
    EXPECT_LT(bones()[b].parent, b);
    EXPECT_EQ(bones()[b].parent < 0, b == 0) << bones()[b].name;
    EXPECT_GT(bones()[b].head_radius, 0.0);
    EXPECT_GT(bones()[b].tail_radius, 0.0);
  }
  for (const char* name : {"pelvis", "thorax", "head", "upper_arm_left", "forearm_right", "hand_left",
                           "thigh_right", "shank_left", "foot_right"})
    EXPECT_TRUE(names.count(name)) << name;
}

TEST(HumanSkeleton, LeftAndRightAreMirrorImages) {
  int pairs = 0;
  for (const Bone& bone : bones()) {
    const std::size_t at = bone.name.find("_left");
    if (at == std::string::npos) continue;
    const std::string other = bone.name.substr(0, at) + "_right";
    const auto right =
        std::find_if(bones().begin(), bones().end(), [&](const Bone& b) { return b.name == other; });
    ASSERT_NE(right, bones().end());
    EXPECT_EQ(right->head, Vec3(-bone.head.x(), bone.head.y(), bone.head.z()));
    EXPECT_EQ(right->tail, Vec3(-bone.tail.x(), bone.tail.y(), bone.tail.z()));
    EXPECT_EQ(right->head_radius, bone.head_radius);
    EXPECT_EQ(right->tail_radius, bone.tail_radius);
    EXPECT_GT(bone.head.x(), 0.0) << "x points to the left of the figure";
    ++pairs;
  }
  EXPECT_EQ(pairs, 7);
}

/// Points on the surface of a bone: circles along its line, and the balls at its two ends.
std::vector<Vec3> surface_points(const Bone& bone) {
  std::vector<Vec3> out;
  const Vec3 along = bone.tail - bone.head;
  for (int i = 0; i <= 12; ++i)
    for (int j = 0; j < 10; ++j)
      for (int k = 0; k < 16; ++k) {
        const double t = i / 12.0, polar = std::numbers::pi * (j + 0.5) / 10.0,
                     azimuth = 2.0 * std::numbers::pi * k / 16.0;
        const double radius = bone.head_radius + t * (bone.tail_radius - bone.head_radius);
        out.push_back(bone.head + t * along +
                      radius * Vec3(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                                    std::cos(polar)));
      }
  return out;
}

TEST(HumanSkeleton, LiesInsideTheTissue) {
  for (const bool fine : {false, true})
    for (const Bone& bone : bones()) {
      double worst = -1.0;
      for (const Vec3& p : surface_points(bone)) worst = std::max(worst, shapes::human(p, fine));
      EXPECT_LT(worst, 0.0) << bone.name << (fine ? ", skin" : ", base");
    }
}

// The function of the body is bitwise even in x, on which the mirrored mesh relies.
TEST(HumanSkeleton, BodyIsItsOwnMirrorImage) {
  for (const Bone& bone : bones())
    for (const Vec3& p : surface_points(bone))
      ASSERT_EQ(shapes::human(p, true), shapes::human(Vec3(-p.x(), p.y(), p.z()), true));
}

}  // namespace
