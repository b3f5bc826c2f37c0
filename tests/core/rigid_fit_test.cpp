#include "core/rigid_fit.h"

#include <gtest/gtest.h>

using namespace palpate;

namespace {

const Points kCorner = (Points(3, 4) << 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3).finished();

TEST(RigidFit, FindsARigidMotion) {
  const Quat turn(Eigen::AngleAxisd(2.5, Vec3(1, -2, 0.5).normalized()));
  const Vec3 way(1, 2, 3);
  const Points after = (turn.toRotationMatrix() * kCorner).colwise() + way;
  const Pose found = rigid_fit(kCorner, after);
  EXPECT_NEAR(found.rotation.angularDistance(turn), 0.0, 1e-7);
  EXPECT_LT((found.translation - way).norm(), 1e-12);
}

// The fitted rotation is never a reflection; for a flat point set both would fit equally well.
TEST(RigidFit, ReflectsNothing) {
  Points flat = kCorner.leftCols(3);
  EXPECT_NEAR(rigid_fit(flat, flat).rotation.angularDistance(Quat::Identity()), 0.0, 1e-7);
  Points mirrored = kCorner;
  mirrored.row(2) *= -1.0;
  EXPECT_NEAR(rigid_fit(kCorner, mirrored).rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
}

// A point of zero weight has no influence; a dominant weight makes its point fit exactly.
TEST(RigidFit, WeighsItsPoints) {
  Points after = kCorner;
  after(0, 3) += 1.0;
  EXPECT_LT((rigid_fit(kCorner, after, VecX(Eigen::Vector4d(1, 1, 1, 0))).translation).norm(), 1e-12);
  const Pose heavy = rigid_fit(kCorner, after, Eigen::Vector4d(1, 1, 1, 1e6));
  const Vec3 carried = heavy.rotation * Vec3(kCorner.col(3)) + heavy.translation;
  EXPECT_LT((carried - after.col(3)).norm(), 1e-5);
}

// With masses, what is left has no momentum, no angular momentum, and nothing of the rigid motion.
TEST(WithoutRigidMotion, LeavesTheDeformation) {
  const VecX masses = Eigen::Vector4d(1, 2, 3, 4);
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(0.2, 1, -0.5).normalized()));
  Points bent = kCorner;
  bent.col(3) += Vec3(0.01, 0.02, -0.03);
  const Points still = without_rigid_motion(kCorner, bent, masses);
  const Points moved =
      without_rigid_motion(kCorner, (turn.toRotationMatrix() * bent).colwise() + Vec3(5, 6, 7), masses);
  EXPECT_LT((moved.colwise().norm() - still.colwise().norm()).norm(), 1e-12);
  EXPECT_GT(still.norm(), 0.01);
  const Vec3 centre = kCorner * masses / masses.sum();
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
  for (int i = 0; i < 4; ++i) {
    momentum += masses[i] * still.col(i);
    angular += masses[i] * Vec3(rigid_fit(kCorner, bent, masses).rotation * Vec3(kCorner.col(i) - centre))
                               .cross(Vec3(still.col(i)));
  }
  EXPECT_LT(momentum.norm(), 1e-12);
  EXPECT_LT(angular.norm(), 1e-12);
}

}  // namespace
