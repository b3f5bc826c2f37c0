#include "palpate/dynamics/linearised_contact.h"

#include <gtest/gtest.h>

using namespace palpate;
using namespace palpate::dynamics;

namespace {

TEST(LinearisedContact, IsLinearInPoseAndTwistAboutItsRecord) {
  LinearisedContact r;
  r.version = 1;
  r.time = 1.0;
  r.F0.fill(1.0);
  EXPECT_EQ(contact_wrench(r, 0.0, {}, {}).norm(), 0.0) << "a record made from nothing pushes nothing";
  r.source = LinearisedContact::Source::kFrozen;
  r.F0 = {0, 0, 0, 0, 0, 2};
  r.J.fill(0);
  r.B.fill(0);
  r.J[35] = -100;  // dFz/dz
  r.J[0] = -3;     // dMx/d(rotation about x)
  r.B[35] = -4;
  const Pose pose{quaternion_of(Vec3(0.2, 0, 0)), Vec3(0, 0, 0.01)};
  Twist twist;
  twist.linear = Vec3(0, 0, 0.5);
  r.v0 = {0, 0, 0, 0, 0, 0.25};
  const Vec6 w = contact_wrench(r, 3.25, pose, twist);
  EXPECT_NEAR(w[5], 2 - 1 - 1, 1e-12);
  EXPECT_NEAR(w[0], -0.6, 1e-12);
}

}  // namespace
