#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "live/page_device.h"

namespace palpate::live {
namespace {

constexpr double kTick = 1e-3;

TEST(HandleFollower, FollowsTheClosedFormOfACriticallyDampedStep) {
  const FollowerLimits limits{100.0, 1e9, 1e9};  // unbounded
  HandleFollower follower({}, limits);
  const Pose target{Quat::Identity(), {0.01, 0.0, 0.0}};
  int checked = 0;
  for (int i = 1; i <= 100; ++i) {
    follower.advance(kTick, target);
    const double wt = limits.rate_per_s * i * kTick;
    EXPECT_NEAR(follower.pose().translation.x(), 0.01 * (1.0 - (1.0 + wt) * std::exp(-wt)), 1e-12);
    EXPECT_NEAR(follower.twist().linear.x(), 0.01 * 100.0 * wt * std::exp(-wt), 1e-10);
    EXPECT_LE(follower.pose().translation.x(), 0.01) << "it does not overshoot";
    ++checked;
  }
  EXPECT_EQ(checked, 100);
}

TEST(HandleFollower, OneLongStepEqualsManyShortOnes) {
  const FollowerLimits limits{100.0, 1e9, 1e9};
  HandleFollower once({}, limits), often({}, limits);
  const Pose target{quaternion_of({0.0, 0.0, 0.4}), {0.01, -0.02, 0.0}};
  once.advance(0.02, target);
  for (int i = 0; i < 20; ++i) often.advance(kTick, target);
  EXPECT_NEAR((once.pose().translation - often.pose().translation).norm(), 0.0, 1e-12);
  EXPECT_NEAR(once.pose().rotation.angularDistance(often.pose().rotation), 0.0, 1e-9);
}

TEST(HandleFollower, LagsAMovingTargetByTwoOverItsRate) {
  HandleFollower follower({});
  const double speed = 0.2;
  Pose target;
  for (int i = 1; i <= 500; ++i) {
    target.translation.x() = speed * i * kTick;
    follower.advance(kTick, target);
  }
  // The target is ahead by half a tick, on average over a tick.
  EXPECT_NEAR(target.translation.x() - follower.pose().translation.x(), speed * 0.020, speed * kTick);
  EXPECT_NEAR(follower.twist().linear.x(), speed, 0.01 * speed);
}

TEST(HandleFollower, StaysWithinItsSpeedAndAcceleration) {
  const FollowerLimits limits;
  HandleFollower follower({}, limits);
  const double w = limits.rate_per_s;
  double fastest = 0.0;
  for (int i = 0; i < 3000; ++i) {  // far jumps to and fro, and ticks of three lengths
    const double side = i / 300 % 2 == 0 ? 1.0 : -1.0;
    const Pose target{quaternion_of({0.0, 3.0 * side, 0.0}), {5.0 * side, 2.0, -side}};
    const double h = i % 7 == 0 ? 13.0 * kTick : kTick;
    const Vec3 before = follower.pose().translation;
    follower.advance(h, target);
    const double speed = follower.twist().linear.norm();
    fastest = std::max(fastest, speed);
    ASSERT_LE(speed, limits.speed_m_s * (1.0 + 1e-9)) << i;
    ASSERT_LE(follower.twist().angular.norm(), limits.turn_rad_s * (1.0 + 1e-9)) << i;
    ASSERT_LE((follower.pose().translation - before).norm(), limits.speed_m_s * h * (1.0 + 1e-9)) << i;
    ASSERT_LE(follower.acceleration().linear.norm(), 4.0 * w * limits.speed_m_s * (1.0 + 1e-9)) << i;
  }
  EXPECT_GT(fastest, 0.9 * limits.speed_m_s) << "the bound was reached";
}

TEST(HandleFollower, SmoothsTheStepsOfAPointer) {
  HandleFollower follower({});
  const double speed = 0.2;
  double least = 1.0, most = 0.0;
  for (int i = 1; i <= 1000; ++i) {
    const double seen = std::floor(i * kTick * 60.0) / 60.0;  // at 60 Hz
    follower.advance(kTick, {Quat::Identity(), {speed * seen, 0.0, 0.0}});
    if (i < 500) continue;
    least = std::min(least, follower.twist().linear.x());
    most = std::max(most, follower.twist().linear.x());
  }
  // 0.798 and 1.115 of the speed, and a tick more or less in each of its steps of 16.7 ms.
  EXPECT_NEAR(least / speed, 0.798, 0.04);
  EXPECT_NEAR(most / speed, 1.115, 0.04);
}

TEST(PageDevice, HoldsItsPoseWithoutTargetsAndFollowsTheNewest) {
  const auto mailbox = std::make_shared<HandleMailbox>();
  const Pose start{Quat::Identity(), {0.0, 0.0, 0.1}};
  PageDevice device(mailbox, start);
  for (int i = 0; i <= 50; ++i) EXPECT_EQ(device.sample(i * kTick).pose.translation, start.translation);
  mailbox->publish(HandleTarget::of({Quat::Identity(), {9.0, 9.0, 9.0}}, 0));
  mailbox->publish(HandleTarget::of({Quat::Identity(), {0.0, 0.0, 0.08}}, 5));
  device::HandleSample sample;
  for (int i = 51; i <= 1000; ++i) {
    sample = device.sample(i * kTick);
    ASSERT_TRUE(sample.valid);
    ASSERT_TRUE(device.sample(i * kTick).pose.translation == sample.pose.translation)
        << "the same time again";
  }
  EXPECT_NEAR(sample.pose.translation.z(), 0.08, 1e-9);
  EXPECT_NEAR(sample.twist.linear.norm(), 0.0, 1e-9);
  EXPECT_EQ(sample.switches, 5U);
}

TEST(PageDevice, StartsAtTheToolThatAssemblyPlaced) {
  const auto mailbox = std::make_shared<HandleMailbox>();
  PageDevice device(mailbox, Pose{Quat::Identity(), {0.0, 0.0, 0.1}});
  const Pose placed{Quat(0.6, 0.0, 0.8, 0.0), {0.0, 0.02, 0.04}};
  device.start_at(placed);
  for (int i = 0; i <= 50; ++i) {
    const device::HandleSample sample = device.sample(i * kTick);
    ASSERT_EQ(sample.pose.translation, placed.translation);
    ASSERT_EQ(sample.pose.rotation.coeffs(), placed.rotation.coeffs());
  }
}

TEST(PageDevice, DoesNotLeaveTheBoundsOfTheScene) {
  const auto mailbox = std::make_shared<HandleMailbox>();
  PageDevice device(mailbox, {});
  device.bound({.center = {0.0, 0.0, 0.0}, .radius = 0.3});
  mailbox->publish(HandleTarget::of({Quat::Identity(), {900.0, 0.0, 0.0}}, 0));
  device.sample(0.0);
  for (int i = 1; i <= 3000; ++i) ASSERT_LE(device.sample(i * kTick).pose.translation.norm(), 0.3 + 1e-12);
  EXPECT_NEAR(device.position().x(), 0.3, 1e-6);
}

}  // namespace
}  // namespace palpate::live
