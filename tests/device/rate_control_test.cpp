// Rate control: the deflection sets the velocity, with a dead zone, in the scene's axes, within the
// workspace.
#include "device/rate_control.h"

#include <gtest/gtest.h>

#include <cmath>

#include "messages.h"

using namespace palpate;
using namespace palpate::device;
using palpate::expectations::expect_contains;
using palpate::expectations::message_of;

namespace {

DeviceSpec spec_with(double speed, double turn_rate, double dead_zone) {
  DeviceSpec spec;
  spec.type = "spacemouse";
  spec.max_speed_m_s = speed;
  spec.max_turn_rate_rad_s = turn_rate;
  spec.dead_zone = dead_zone;
  return spec;
}

}  // namespace

TEST(RateControl, moves_with_the_velocity_of_the_last_sample) {
  DeviceSpec spec = spec_with(0.2, 0.5, 0.0);
  spec.start_position_m = Vec3(1, 2, 3);
  spec.start_rotation_vector_rad = Vec3(0, 0, 0.3);
  RateControl rate(spec);
  rate.advance(5.0, {Vec3(0.5, 0, -1), Vec3(0, 0, 1)});
  EXPECT_EQ(rate.pose().translation, Vec3(1, 2, 3)) << "no time has passed";
  EXPECT_LT((rate.twist().linear - Vec3(0.1, 0, -0.2)).norm(), 1e-14);
  rate.advance(5.0, {Vec3(0.5, 0, -1), Vec3(0, 0, 1)});
  EXPECT_EQ(rate.pose().translation, Vec3(1, 2, 3));
  rate.advance(6.5, {});
  EXPECT_LT((rate.pose().translation - Vec3(1.15, 2, 2.7)).norm(), 1e-13);
  EXPECT_NEAR(rotation_vector(rate.pose().rotation).z(), 0.3 + 0.5 * 1.5, 1e-14);
  EXPECT_EQ(rate.twist().linear, Vec3(0, 0, 0)) << "released: it stays where it is";
  rate.advance(9.0, {});
  EXPECT_LT((rate.pose().translation - Vec3(1.15, 2, 2.7)).norm(), 1e-13);
}

TEST(RateControl, has_a_dead_zone_per_axis_and_full_speed_at_full_deflection) {
  RateControl rate(spec_with(1.0, 2.0, 0.2));
  rate.advance(0.0, {Vec3(0.2, -0.19, 0.6), Vec3(-0.6, 1.0, 7.0)});
  EXPECT_LT((rate.twist().linear - Vec3(0, 0, 0.5)).norm(), 1e-14);
  EXPECT_LT((rate.twist().angular - Vec3(-1.0, 2.0, 2.0)).norm(), 1e-14);
}

TEST(RateControl, turns_into_the_axes_of_the_scene) {
  DeviceSpec spec = spec_with(1.0, 1.0, 0.0);
  spec.mounting_rotation_rad = Vec3(0, 0, M_PI / 2.0);  // the device's x becomes the scene's y
  RateControl rate(spec);
  rate.advance(0.0, {Vec3(1, 0, 0), Vec3(0, 0.5, 0)});
  EXPECT_LT((rate.twist().linear - Vec3(0, 1, 0)).norm(), 1e-14);
  EXPECT_LT((rate.twist().angular - Vec3(-0.5, 0, 0)).norm(), 1e-14);
}

TEST(RateControl, stays_in_the_workspace_and_slides_along_its_border) {
  DeviceSpec spec = spec_with(1.0, 1.0, 0.0);
  spec.workspace_size_m = Vec3(0.2, 0.2, 0.2);
  RateControl rate(spec);
  for (int i = 0; i <= 500; ++i) rate.advance(1e-3 * i, {Vec3(1, 0.1, 0), Vec3::Zero()});
  EXPECT_NEAR(rate.pose().translation.x(), 0.1, 1e-12);
  EXPECT_NEAR(rate.pose().translation.y(), 0.05, 1e-12) << "the other axis goes on";
  EXPECT_NEAR(rate.twist().linear.x(), 0.0, 1e-12) << "the twist is that of the motion";
  rate.advance(0.6, {Vec3(-1, 0, 0), Vec3::Zero()});
  rate.advance(0.65, {});
  EXPECT_NEAR(rate.pose().translation.x(), 0.05, 1e-12) << "it returns at once";

  RateControl ball(spec_with(1.0, 1.0, 0.0));
  PoseBounds bounds;
  bounds.radius = 0.3;
  ball.bound(bounds);
  for (int i = 0; i <= 2000; ++i) ball.advance(1e-3 * i, {Vec3(1, 1, 1), Vec3::Zero()});
  EXPECT_NEAR(ball.pose().translation.norm(), 0.3, 1e-9);
}

TEST(RateControl, from_outside_it_only_moves_inwards) {
  DeviceSpec spec = spec_with(1.0, 1.0, 0.0);
  spec.workspace_radius_m = 0.1;
  spec.start_position_m = Vec3(0.5, 0, 0);
  RateControl rate(spec);
  rate.advance(0.0, {Vec3(1, 0, 0), Vec3::Zero()});
  EXPECT_EQ(rate.twist().linear, Vec3(0, 0, 0));
  EXPECT_EQ(rate.pose().translation, Vec3(0.5, 0, 0)) << "no jump";
  rate.advance(0.1, {Vec3(-1, 0, 0), Vec3::Zero()});
  EXPECT_EQ(rate.twist().linear, Vec3(-1, 0, 0));
}

TEST(RateControl, bad_settings_are_refused) {
  expect_contains(message_of([] { RateControl{spec_with(-1.0, 1.0, 0.1)}; }),
                  "device: max_speed_m_s = -1 must not be negative; 0 holds the handle");
  expect_contains(message_of([] { RateControl{spec_with(1.0, NAN, 0.1)}; }), "max_turn_rate_rad_s = nan");
  expect_contains(message_of([] { RateControl{spec_with(1.0, 1.0, 1.0)}; }),
                  "dead_zone = 1 must lie in [0, 0.9]");
  DeviceSpec spec = spec_with(1.0, 1.0, 0.1);
  spec.start_position_m = Vec3(NAN, 0, 0);
  expect_contains(message_of([&] { RateControl{spec}; }), "start_position_m must be three finite numbers");
}
