#include "palpate/core/pose.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

using namespace palpate;

namespace {
constexpr double kPi = std::numbers::pi;
const Vec3 kAxis = Vec3(1, -2, 3).normalized();
}  // namespace

TEST(Pose, RotationVectorRoundTripKeepsRelativeAccuracyAtEveryAngle) {
  for (const double angle :
       {1e-200, 1e-30, 1e-12, 1e-8, 1e-4, 0.1, 1.0, kPi / 2, 3.0, kPi - 1e-4, kPi - 1e-9}) {
    const Vec3 r = angle * kAxis;
    EXPECT_LE((rotation_vector(quaternion_of(r)) - r).cwiseAbs().maxCoeff(), 1e-15 * std::max(angle, 0.0) * 4)
        << angle;
  }
  EXPECT_EQ(rotation_vector(quaternion_of(Vec3::Zero())), Vec3::Zero());
}

TEST(Pose, AnglesBeyondPiComeBackAsTheShorterWayRound) {
  const Vec3 back = rotation_vector(quaternion_of((kPi + 0.25) * kAxis));
  EXPECT_LE((back + (kPi - 0.25) * kAxis).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(Pose, BothSignsOfAQuaternionAreOneRotation) {
  for (const Quat& q : {quaternion_of(0.3 * kAxis), quaternion_of(-2.9 * kAxis), Quat(0, 0, -0.6, 0.8),
                        Quat(0, 1, 0, 0), Quat(1, 0, 0, 0)}) {
    const Quat minus(-q.w(), -q.x(), -q.y(), -q.z());
    EXPECT_EQ(rotation_vector(q), rotation_vector(minus));
    EXPECT_LE(rotation_vector(q).norm(), kPi + 1e-15);
  }
  EXPECT_NEAR(rotation_vector(Quat(0, 0, -0.6, 0.8)).norm(), kPi, 1e-15);
}

TEST(Pose, QuaternionsAreUnitAndTurnTheRightWay) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-4, 4);
  for (int i = 0; i < 1000; ++i) {
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    EXPECT_NEAR(quaternion_of({x, y, z}).norm(), 1.0, 4e-16);
  }
  EXPECT_LE((quaternion_of({0, 0, kPi / 2}) * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
}

TEST(Pose, DifferenceCarriesOnePoseToTheOther) {
  const Pose from{quaternion_of({0.4, -0.2, 1.1}), {1, 2, 3}},
      to{quaternion_of({-0.9, 0.8, 0.1}), {-4, 0.5, 2}};
  const Vec6 d = pose_difference(from, to);
  const Quat carried = quaternion_of(d.head<3>()) * from.rotation;
  EXPECT_LE(carried.angularDistance(to.rotation), 1e-14);
  EXPECT_EQ(Vec3(d.tail<3>()), Vec3(-5, -1.5, -1));
  EXPECT_EQ(pose_difference(from, from).tail<3>(), Vec3::Zero());
  EXPECT_LE(pose_difference(from, from).head<3>().norm(), 1e-15);
}

TEST(Pose, CompositionAndInverseAgreeWithPoints) {
  const Pose a{quaternion_of({0.4, -0.2, 1.1}), {1, 2, 3}}, b{quaternion_of({-0.9, 0.8, 0.1}), {-4, 0.5, 2}};
  const Vec3 p(0.3, 0.7, -0.4);
  EXPECT_LE(((a * b) * p - a * (b * p)).norm(), 1e-14);
  EXPECT_LE((a.inverse() * (a * p) - p).norm(), 1e-14);
}
