#include "bones/shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "messages.h"
#include "palpate/core/pose.h"

using namespace palpate;
using namespace palpate::bones;
using namespace palpate::expectations;

namespace {

std::vector<BoneSpec> shapes() {
  BoneSpec sphere, box, cylinder;
  sphere.name = "sphere";
  sphere.shape = BoneShape::kSphere;
  box.name = "box";
  box.shape = BoneShape::kBox;
  cylinder.name = "cylinder";
  cylinder.shape = BoneShape::kCylinder;
  sphere.radius_m = 0.02;
  box.size_m = Vec3(0.03, 0.04, 0.05);
  cylinder.radius_m = 0.02;
  cylinder.length_m = 0.07;
  BoneSpec capsule = cylinder;
  capsule.name = "capsule";
  capsule.shape = BoneShape::kCapsule;
  return {sphere, box, cylinder, capsule};
}

}  // namespace

// Volume and second moments equal those of the region for which inside_bone() returns true, integrated by the
// midpoint rule on a grid that is rotated against the shape, so that no face is aligned with it.
TEST(Bone, MassAndInertiaAreThoseOfItsInside) {
  for (BoneSpec spec : shapes()) {
    spec.density_kg_m3 = 1800.0;
    const double cell = 0.001;
    const Mat3 rotation = quaternion_of(Vec3(0.4, -0.7, 0.9)).toRotationMatrix();
    double volume = 0.0;
    Vec3 moments = Vec3::Zero();
    for (double x = -0.06 + cell / 2; x < 0.06; x += cell)
      for (double y = -0.06 + cell / 2; y < 0.06; y += cell)
        for (double z = -0.06 + cell / 2; z < 0.06; z += cell) {
          const Vec3 p = rotation * Vec3(x, y, z);
          if (!inside_bone(spec, p)) continue;
          volume += cell * cell * cell;
          moments += cell * cell * cell * (p.squaredNorm() - p.array().square()).matrix();
        }
    const BoneInertia inertia = bone_inertia(spec);
    EXPECT_NEAR(bone_volume(spec) / volume, 1.0, 5e-3) << spec.name;
    EXPECT_NEAR(inertia.mass / (1800.0 * volume), 1.0, 5e-3) << spec.name;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(inertia.principal[k] / (1800.0 * moments[k]), 1.0, 1e-2) << spec.name << ", axis " << k;
  }
}

TEST(Bone, SurfaceIsClosedOrientedAndOnTheBorder) {
  for (const BoneSpec& spec : shapes()) {
    const TriMesh s = bone_surface(spec);
    double volume = 0.0;
    for (const auto& f : s.faces.colwise())
      volume += s.vertices.col(f[0]).dot(s.vertices.col(f[1]).cross(s.vertices.col(f[2]))) / 6.0;
    EXPECT_NEAR(volume / bone_volume(spec), 1.0, 0.06)
        << spec.name << ": a facetted body is a little smaller";
    EXPECT_GT(volume, 0.0);
    EXPECT_EQ(2 * s.vertices.cols() - 4, s.faces.cols()) << spec.name << ": Euler";
    for (const auto& v : s.vertices.colwise()) {
      EXPECT_TRUE(inside_bone(spec, 0.999 * v)) << spec.name;
      EXPECT_FALSE(inside_bone(spec, 1.001 * v)) << spec.name;
    }
  }
  EXPECT_EQ(bone_surface({}).vertices.cols(), 0);
}

TEST(Bone, GivenNumbersComeBeforeTheShapes) {
  BoneSpec spec = shapes()[0];
  spec.mass_kg = 0.3;
  EXPECT_NEAR(bone_inertia(spec).principal.x(), 0.4 * 0.3 * 4e-4, 1e-18);
  spec.inertia_kg_m2 = Vec3(1e-4, 2e-4, 2.5e-4);
  EXPECT_EQ(bone_inertia(spec).principal, spec.inertia_kg_m2);
  spec.inertia_kg_m2 = Vec3(1e-4, 2e-4, 4e-4);
  expect_contains(message_of([&] { bone_inertia(spec); }),
                  "bone \"sphere\": inertia_kg_m2 = [0.0001, 0.0002, 0.0004] is impossible");
}
