// The tool's ticks use forces in closed form, which must equal Simbody's forward dynamics.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "simbody_body.h"

namespace {

using namespace palpate;

TEST(NewtonEuler, IsSimbodysForwardDynamics) {
  tool::RigidParameters p;
  p.mass = 0.13;
  p.inertia = Vec3(2e-5, 5e-5, 6e-5);
  p.gravity = Vec3(0.3, -0.2, -9.8);
  tool::SimbodyBody body(p);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  const auto vec = [&](double size) { return Vec3(size * Vec3(in(random), in(random), in(random))); };
  const auto pose = [&] { return Pose{quaternion_of(vec(2.0)), vec(0.05)}; };
  for (int k = 0; k < 20; ++k) {
    tool::RigidMotion motion{pose(), {vec(40.0), vec(0.5)}};
    tool::TickInput input;
    input.t0 = 0.2;
    input.h = 1e-3;
    input.gains = {300.0, 2.0, 0.05, 3e-4};
    input.handle = {pose(), pose(), {vec(3.0), vec(0.2)}, {vec(3.0), vec(0.2)}};
    input.contact.version = 1;
    input.contact.source = dynamics::LinearisedContact::Source::kFrozen;
    input.contact.samples = 3;
    for (double& f : input.contact.F0) f = in(random);
    for (double& j : input.contact.J) j = 20.0 * in(random);
    for (double& b : input.contact.B) b = 0.1 * in(random);
    const Vec6 theirs = body.acceleration(0.2004, motion, input);
    const Vec6 ours = body.mass_matrix(motion.pose).ldlt().solve(body.right_hand_side(0.2004, motion, input));
    EXPECT_LT((ours - theirs).norm(), 1e-11 * theirs.norm()) << k;
  }
}

// Where an explicit method diverges, the result states this, rather than throwing an exception of Simbody's.
TEST(NewtonEuler, IsNoNumberWhereThereIsNoPlace) {
  tool::SimbodyBody body(tool::RigidParameters{});
  const double none = std::numeric_limits<double>::quiet_NaN();
  const tool::RigidMotion turned{{Quat(none, none, 0.0, 0.0), Vec3::Zero()}, {}};
  EXPECT_FALSE(body.calc_force(0.0, turned).allFinite());
  EXPECT_TRUE(std::isnan(body.calc_potential_energy(turned)));
  EXPECT_FALSE(body.calc_mass(turned).allFinite());
  EXPECT_TRUE(body.calc_force(0.0, {}).allFinite());
}

}  // namespace
