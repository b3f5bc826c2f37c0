// Samples clustered into the points of a reduced contact model: they have the loads, the friction springs and
// the grasps of their samples.
#include <gtest/gtest.h>

#include <random>

#include "reduced_contact.h"

namespace palpate {
namespace {

using namespace contact_tests::reduced_contact;
using contact::ReducedContactModel;

// 500 samples of a dent with different depths and normals are clustered into the maximum number of points:
// tool and bodies receive the same loads to rounding, so that a state of rest is preserved, also with
// sticking friction.
void expect_loads_kept(double friction) {
  constexpr double kRetardation = 5e-3, kSpeed = 2e-4;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  const Pose pose{quaternion_of(Vec3(0.3, 0.2, -0.4)), Vec3(0.1, 0.2, 0.3)};
  const Mat3 R = pose.rotation.toRotationMatrix();
  std::vector<contact::ReducedSample> samples;
  Vec3 force = Vec3::Zero(), moment = force;
  Mat3 stiffness = Mat3::Zero();
  using Modes = Eigen::Matrix<double, kModes, Eigen::Dynamic>;
  const Modes modes = Modes::NullaryExpr(kModes, 3 * 700, [&] { return in(random); });
  Eigen::Matrix<double, kModes, 1> load = Modes::Zero(kModes, 1);
  for (int j = 0; j < 700; ++j) {
    const Vec3 across(0.01 * in(random), 0.01 * in(random), 0.0);
    const Vec3 normal = Vec3(30.0 * across.x(), 30.0 * across.y(), 1.0).normalized();
    const double gap = j < 500 ? -1e-3 * (1.1 + in(random)) : 1e-3 * (1.1 + in(random)), area = 1e-6;
    const Vec3 arm = across - 0.02 * normal;
    contact::ReducedSample s{};
    s.offset = R.transpose() * arm;
    s.slide = Vec3::Zero();
    s.normal = normal;
    s.place = pose.translation + arm - gap * normal;
    s.velocity = Vec3::Zero();
    s.count = 1;
    s.node[0] = j;
    s.weight[0] = 1.0;
    s.area = area;
    s.gap = gap;
    s.force = Vec3::Zero();
    if (gap < 0.0 && friction > 0.0) {
      const Vec3 u = Vec3(in(random), 0.5 + in(random), in(random));
      s.deflection = 0.5 * kRetardation * kSpeed * (u - normal.dot(u) * normal);
      s.friction_stiffness = -friction * 1e6 * area * gap / (kRetardation * kSpeed);
    }
    samples.push_back(s);
    if (gap >= 0.0) continue;
    const Vec3 f = -1e6 * area * gap * normal - s.friction_stiffness * s.deflection;
    force += f;
    moment += arm.cross(f);
    stiffness += 1e6 * area * normal * normal.transpose();
    load += modes.middleCols<3>(3 * j) * f;
  }
  ReducedContactModel model;
  contact::gather_points(samples, pose, modes, model);
  EXPECT_EQ(model.points, ReducedContactModel::kMostPoints);
  for (int i = 0; i < model.points; ++i) {
    ReducedContactModel::Point& p = model.point[static_cast<std::size_t>(i)];
    const auto vec = [](const std::array<double, 3>& a) { return Vec3(a[0], a[1], a[2]); };
    const Vec3 n = vec(p.normal);
    const double gap = n.dot(pose.translation + R * vec(p.offset) + vec(p.slide) - vec(p.place));
    const Vec3 u = vec(p.deflection);
    if (gap < 0.0)
      load += Eigen::Map<const Eigen::Matrix<double, 3, kModes>>(p.modes.data()).transpose() *
              (1e6 * p.area * gap * (n - friction / (kRetardation * kSpeed) * (u - n.dot(u) * n)));
    p.modes.fill(0.0);  // bodies without response, from here on
  }
  load += Eigen::Map<const Eigen::Matrix<double, kModes, 1>>(model.missing_load.data());
  EXPECT_LE(load.norm(), 1e-11 * force.norm());
  ContactSpec spec = law();
  spec.friction = friction;
  spec.friction_regularisation_m_s = kSpeed;
  spec.friction_retardation_s = kRetardation;
  contact::ReducedContactStepper ticks({spec});
  ticks.adopt(model);
  const auto record = ticks.linearise(1e-3, 1e-3, {pose, {}});
  EXPECT_GT(ticks.pressing(), ReducedContactModel::kMostPoints / 2);
  EXPECT_LT(ticks.pressing(), ReducedContactModel::kMostPoints) << "there is room for what is apart";
  const Eigen::Map<const Vec6> F(record.F0.data());
  EXPECT_LE((F.tail<3>() - force).norm(), 1e-12 * force.norm());
  EXPECT_LE((F.head<3>() - moment).norm(), 1e-12 * 0.02 * force.norm());
  if (friction > 0.0) {
    EXPECT_GT(F.segment<2>(3).norm(), 0.1 * friction * force.norm());
    const Pose away{pose.rotation, pose.translation + Vec3(0, 0, 0.01)};
    const auto lifted = ticks.linearise(2e-3, 1e-3, {away, {}});
    EXPECT_EQ(Eigen::Map<const Vec6>(lifted.F0.data()).norm(), 0.0)
        << "nothing of it stays on a tool that left";
    return;
  }
  using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  const Mat3 J = Eigen::Map<const RowMajor6>(record.J.data()).bottomRightCorner<3, 3>();
  EXPECT_LE((J + stiffness).norm(), 0.02 * stiffness.norm());
}

TEST(TouchPoints, ABunchPressesWithTheForceMomentAndModalLoadOfItsSamples) {
  expect_loads_kept(0.0);
  expect_loads_kept(0.4);
}

// Sticking friction is a spring: as the tool moves and rotates across the points, its force grows with the
// displacement of the tool's material, up to the law's maximum.
TEST(ReducedContactStepper, WhatSticksHasASpring) {
  constexpr double kRetardation = 5e-3, kSpeed = 2e-4, kFriction = 0.4, kArea = 1e-6, kGap = -1e-3;
  ContactSpec spec = law();
  spec.friction = kFriction;
  spec.friction_regularisation_m_s = kSpeed;
  spec.friction_retardation_s = kRetardation;
  const Pose pose{quaternion_of(Vec3(0.3, 0.2, -0.4)), Vec3(0.1, 0.2, 0.3)};
  const Vec3 arm(0.01, 0.0, -0.02), centre(0.01, 0.0, 0.0), normal = Vec3::UnitZ();
  for (const bool round : {false, true}) {  // a ball's contact point slides with its centre
    contact::ReducedSample s{};
    const Mat3 back = pose.rotation.toRotationMatrix().transpose();
    s.offset = back * (round ? centre : arm);
    s.slide = round ? Vec3(arm - centre) : Vec3(Vec3::Zero());
    s.normal = normal;
    s.place = pose.translation + arm - kGap * normal;
    s.count = 1;
    s.area = kArea;
    s.gap = kGap;
    s.velocity = s.force = Vec3::Zero();
    s.deflection = Vec3(2e-7, 0.0, 0.0);
    const double L = -kFriction * 1e6 * kArea * kGap, stiffness = L / (kRetardation * kSpeed);
    s.friction_stiffness = stiffness;
    ReducedContactModel model;
    contact::gather_points({s}, pose, Eigen::Matrix<double, kModes, Eigen::Dynamic>::Zero(kModes, 3), model);
    contact::ReducedContactStepper ticks({spec});
    ticks.adopt(model);
    const auto friction = [&](const Vec3& moved, const Vec3& turned) {
      const Pose now{quaternion_of(turned) * pose.rotation, pose.translation + moved};
      const auto record = ticks.linearise(1e-3, 1e-3, {now, {}});
      return Vec3(Eigen::Map<const Vec6>(record.F0.data()).tail<3>());
    };
    const auto expect = [&](const Vec3& seen, const Vec3& deflection, const char* what) {
      EXPECT_LT((seen.head<2>() + stiffness * deflection.head<2>()).norm(), 1e-5 * L) << what << round;
    };
    expect(friction(Vec3::Zero(), Vec3::Zero()), s.deflection, "at rest ");
    const Vec3 way(1e-7, -3e-7, 0.0), turn(1e-6, 2e-6, 3e-6);
    expect(friction(way, Vec3::Zero()), s.deflection + way, "moved ");
    expect(friction(way, turn), s.deflection + way + turn.cross(arm), "moved and turned ");
    const Vec3 far(0.0, 1e-4, 0.0);
    EXPECT_NEAR(friction(far, Vec3::Zero()).head<2>().norm(), L, 1e-9 * L) << "Coulomb's, at most";
  }
}

// Held samples are clustered as well: the same force, and nearly the same rotational stiffness.
TEST(TouchPoints, ABunchHoldsAsItsSamplesDo) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  const Pose pose{quaternion_of(Vec3(0.3, 0.2, -0.4)), Vec3(0.1, 0.2, 0.3)};
  const Mat3 R = pose.rotation.toRotationMatrix();
  std::vector<contact::ReducedSample> samples;
  Vec3 force = Vec3::Zero(), moment = force;
  Mat3 turning = Mat3::Zero();
  for (int j = 0; j < 500; ++j) {
    const Vec3 arm(0.01 * in(random), 0.01 * in(random), -0.02), up = Vec3(1e-3, 0.0, 2e-3);
    contact::ReducedSample s{};
    s.offset = R.transpose() * (arm + up);
    s.slide = s.velocity = s.force = Vec3::Zero();
    s.normal = Vec3::UnitZ();
    s.place = pose.translation + arm;
    s.area = 1e-6;
    s.gap = 2e-3;
    s.held = true;
    s.stiffness = 1.0;
    samples.push_back(s);
    force -= up;
    moment -= arm.cross(up);
    turning -= cross_matrix(arm) * cross_matrix(arm);
  }
  ReducedContactModel model;
  contact::gather_points(samples, pose, Eigen::Matrix<double, kModes, Eigen::Dynamic>::Zero(kModes, 3),
                         model);
  EXPECT_EQ(model.points, ReducedContactModel::kMostPoints);
  contact::ReducedContactStepper ticks({law()});
  ticks.adopt(model);
  const auto record = ticks.linearise(1e-3, 1e-3, {pose, {}});
  const Eigen::Map<const Vec6> F(record.F0.data());
  EXPECT_LE((F.tail<3>() - force).norm(), 1e-12 * force.norm());
  EXPECT_LE((F.head<3>() - moment).norm(), 1e-12 * moment.norm());
  using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  const Mat6 J = Eigen::Map<const RowMajor6>(record.J.data());
  EXPECT_NEAR(J(5, 5), -500.0, 1e-9);
  EXPECT_NEAR(J(2, 2), -turning(2, 2), 0.02 * turning(2, 2));
}

}  // namespace
}  // namespace palpate
