#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bones/shape.h"
#include "palpate/core/error.h"
#include "palpate/mesh/quality.h"

using namespace palpate;
using std::numbers::pi;

namespace {

palpate::Bone bone_of(double r0, double r1, double length) {
  palpate::Bone b;
  b.name = "tapered bone";
  b.head = Vec3(0.1, -0.2, 0.3);
  b.tail = b.head + length * Vec3(2.0, -1.0, 2.0) / 3.0;
  b.head_radius = r0;
  b.tail_radius = r1;
  return b;
}

/// Volume, centre and second moments of a closed surface, summed over tetrahedra from the origin: exact for
/// the polyhedron.
struct Solid {
  double volume = 0.0;
  Vec3 middle = Vec3::Zero(), moments = Vec3::Zero();
  explicit Solid(const TriMesh& mesh) {
    Mat3 second = Mat3::Zero();
    for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
      const Vec3 a = mesh.vertices.col(mesh.faces(0, f)), b = mesh.vertices.col(mesh.faces(1, f)),
                 c = mesh.vertices.col(mesh.faces(2, f)), s = a + b + c;
      const double v = a.dot(b.cross(c)) / 6.0;
      volume += v;
      middle += v * s / 4.0;
      second += v / 20.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
    }
    middle /= volume;
    const Mat3 about = second / volume - middle * middle.transpose();
    moments = Vec3::Constant(about.trace()) - about.diagonal();
  }
};

}  // namespace

// Capsule and ball have closed forms (shape.cpp), which a tapered bone of equal radii must reproduce.
TEST(TaperedBone, OfOneRadiusIsTheCapsule) {
  BoneSpec capsule;
  capsule.name = "c";
  capsule.shape = BoneShape::kCapsule;
  capsule.radius_m = 0.02;
  capsule.length_m = 0.11;
  capsule.mass_kg = 1.0;
  const bones::TaperedBone bone = bones::tapered_bone(bone_of(0.02, 0.02, 0.11));
  EXPECT_NEAR(bone.volume, bones::bone_volume(capsule), 1e-15);
  EXPECT_LT((bone.unit_moments - bones::bone_inertia(capsule).principal).norm(), 1e-15);
  EXPECT_LT((bone.frame.translation - (bone_of(0.02, 0.02, 0.11).head + 0.055 * Vec3(2, -1, 2) / 3.0)).norm(),
            1e-15);
  EXPECT_LT((bone.frame.rotation * Vec3::UnitZ() - Vec3(2, -1, 2) / 3.0).norm(), 1e-15);
}

TEST(TaperedBone, WhoseBallHoldsTheOtherIsThatBall) {
  for (const bool tail : {false, true}) {
    const palpate::Bone b = tail ? bone_of(0.01, 0.05, 0.03) : bone_of(0.05, 0.01, 0.03);
    const bones::TaperedBone bone = bones::tapered_bone(b);
    EXPECT_NEAR(bone.volume, 4.0 / 3.0 * pi * std::pow(0.05, 3), 1e-16);
    EXPECT_LT((bone.unit_moments - Vec3::Constant(0.4 * 0.05 * 0.05)).norm(), 1e-16);
    EXPECT_LT((bone.frame.translation - (tail ? b.tail : b.head)).norm(), 1e-15);
  }
}

// The surface mesh is inscribed, with 24 meridians and 6 rings per cap: its cross-sections are smaller by 1 -
// (24/2 pi) sin(2 pi/24) = 1.1 %, and its caps by as much again.
TEST(TaperedBone, HasTheMassOfItsSurface) {
  for (const auto& [r0, r1] : {std::pair{0.03, 0.015}, {0.01, 0.04}, {0.02, 0.02}}) {
    const palpate::Bone b = bone_of(r0, r1, 0.12);
    const bones::TaperedBone bone = bones::tapered_bone(b);
    const TriMesh surface = bones::tapered_bone_surface(b);
    const Solid solid(surface);
    EXPECT_GT(solid.volume, 0.0) << "outwards";
    EXPECT_NEAR(solid.volume / bone.volume, 1.0, 0.03);
    EXPECT_LT(solid.volume, bone.volume);
    EXPECT_LT(solid.middle.norm(), 0.01 * 0.12) << "the frame's origin is the centre of mass";
    EXPECT_LT(((solid.moments - bone.unit_moments).array() / bone.unit_moments.array()).abs().maxCoeff(),
              0.04);
    EXPECT_NEAR(surface.vertices.row(2).maxCoeff() - surface.vertices.row(2).minCoeff(), 0.12 + r0 + r1,
                1e-12);
  }
}

TEST(TaperedBone, NeedsRadii) { EXPECT_THROW(bones::tapered_bone(bone_of(0.0, 0.01, 0.1)), Error); }
