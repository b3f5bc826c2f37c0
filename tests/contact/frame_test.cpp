#include "fixture.h"

using namespace contact_tests;

namespace {

/// A smooth motion with exact twist: rotation exp(a(t)) exp(b(t)) about two fixed axes n and m, so that the
/// axis of the product varies; w = a' n + exp(a n) (b' m).
struct Motion {
  Vec3 n = Vec3(1, 2, -1).normalized(), m = Vec3(0, 1, 3).normalized();
  Pose pose(double t) const {
    return {quaternion_of(std::sin(2 * t) * n) * quaternion_of(std::cos(3 * t) * m),
            Vec3(std::sin(t), std::cos(2 * t), t * t)};
  }
  Twist twist(double t) const {
    return {2 * std::cos(2 * t) * n + quaternion_of(std::sin(2 * t) * n) * Vec3(-3 * std::sin(3 * t) * m),
            Vec3(std::cos(t), -2 * std::sin(2 * t), 2 * t)};
  }
};

dynamics::StateView at(double t) {
  dynamics::StateView view;
  view.time = t;
  return view;
}

contact::TrajectoryFrame ticks(const Motion& motion, double h, int count) {
  contact::TrajectoryFrame frame;
  for (int i = 0; i <= count; ++i) frame.append(i * h, motion.pose(i * h), motion.twist(i * h));
  return frame;
}

}  // namespace

TEST(TrajectoryFrame, MeetsItsKnots) {
  const Motion motion;
  const auto frame = ticks(motion, 0.1, 5);
  for (int i = 0; i <= 5; ++i) {
    const double t = 0.1 * i;
    EXPECT_LT(pose_difference(motion.pose(t), frame.pose(at(t))).norm(), 1e-14);
    EXPECT_LT((motion.twist(t).angular - frame.twist(at(t)).angular).norm(), 1e-12);
    EXPECT_LT((motion.twist(t).linear - frame.twist(at(t)).linear).norm(), 1e-12);
    // left limit, at the end of the preceding interval
    if (i > 0) { EXPECT_LT((motion.twist(t).angular - frame.twist(at(t - 1e-9)).angular).norm(), 1e-6); }
  }
}

// Cubic Hermite interpolation: error h^4 in the pose, h^3 in the twist.
TEST(TrajectoryFrame, PoseOfOrderFourTwistOfOrderThree) {
  const Motion motion;
  std::vector<double> pose_error, twist_error;
  for (const int count : {8, 16, 32, 64}) {
    const double h = 1.0 / count;
    const auto frame = ticks(motion, h, count);
    double worst_pose = 0, worst_twist = 0;
    for (int i = 0; i < 400; ++i) {
      const double t = (i + 0.37) / 400;
      worst_pose = std::max(worst_pose, pose_difference(motion.pose(t), frame.pose(at(t))).norm());
      worst_twist = std::max(worst_twist, (motion.twist(t).angular - frame.twist(at(t)).angular).norm());
    }
    pose_error.push_back(worst_pose);
    twist_error.push_back(worst_twist);
  }
  for (std::size_t i = 1; i < pose_error.size(); ++i) {
    EXPECT_NEAR(std::log2(pose_error[i - 1] / pose_error[i]), 4.0, 0.3) << i;
    EXPECT_NEAR(std::log2(twist_error[i - 1] / twist_error[i]), 3.0, 0.3) << i;
  }
}

// The twist is the derivative of the pose, also in the middle of an interval (central differences, error
// h^2).
TEST(TrajectoryFrame, TwistIsTheDerivativeOfThePose) {
  const auto frame = ticks(Motion{}, 0.25, 4);
  for (const double t : {0.1, 0.33, 0.6, 0.9}) {
    const double h = 1e-5;
    const Vec6 difference = pose_difference(frame.pose(at(t - h)), frame.pose(at(t + h))) / (2 * h);
    EXPECT_LT((difference.head<3>() - frame.twist(at(t)).angular).norm(), 1e-7) << t;
    EXPECT_LT((difference.tail<3>() - frame.twist(at(t)).linear).norm(), 1e-7) << t;
  }
}

TEST(TrajectoryFrame, RestartsFromItsLastKnot) {
  contact::TrajectoryFrame frame;
  EXPECT_THROW(frame.last(), InternalError);
  frame.append(0.1, {Quat::Identity(), Vec3(1, 0, 0)}, {});
  frame.append(0.2, {Quat::Identity(), Vec3(2, 0, 0)}, {Vec3::Zero(), Vec3(3, 0, 0)});
  frame.restart();
  EXPECT_EQ(frame.last().t, 0.2);
  EXPECT_EQ(frame.last().pose.translation, Vec3(2, 0, 0));
  EXPECT_NEAR(frame.pose(at(0.1)).translation.x(), 1.7, 1e-15) << "extrapolated, the first knot is gone";
  frame.append(0.3, {Quat::Identity(), Vec3(4, 0, 0)}, {});
  EXPECT_EQ(frame.last().t, 0.3);
}

TEST(TrajectoryFrame, GoesOnWithTheTwistOutsideAndStandsOnOneKnot) {
  contact::TrajectoryFrame frame;
  EXPECT_THROW(frame.pose(at(0)), InternalError);
  frame.append(1.0, {Quat::Identity(), Vec3(1, 0, 0)}, {Vec3(0, 0, 2), Vec3(0, 3, 0)});
  const Pose later = frame.pose(at(1.5));
  EXPECT_LT((later.translation - Vec3(1, 1.5, 0)).norm(), 1e-15);
  EXPECT_LT((rotation_vector(later.rotation) - Vec3(0, 0, 1)).norm(), 1e-15);
  EXPECT_LT((frame.pose(at(0.5)).translation - Vec3(1, -1.5, 0)).norm(), 1e-15);
  EXPECT_THROW(frame.append(1.0, {}, {}), InternalError);
  EXPECT_EQ(frame.u_offset(at(0)), -1);
  EXPECT_FALSE(frame.in_state());
}

TEST(BlockFrame, ReadsItsBlock) {
  World world(3, true, 1);
  const auto frame = contact::block_frame(world.body_id);
  const auto view = world.state.view();
  EXPECT_EQ(frame->u_offset(view), 9);
  EXPECT_TRUE(frame->in_state());
  EXPECT_EQ(frame->pose(view).translation, Vec3(view.q[13], view.q[14], view.q[15]));
  EXPECT_EQ(frame->twist(view).angular, Vec3(view.u[9], view.u[10], view.u[11]));
  EXPECT_THROW(contact::block_frame(77)->pose(view), InternalError);
  EXPECT_THROW(contact::block_frame(world.nodes_id)->pose(view), InternalError);
}

TEST(FixedFrame, Stays) {
  const Pose pose{quaternion_of(Vec3(0, 1, 0)), Vec3(1, 2, 3)};
  const auto frame = contact::fixed_frame(pose);
  EXPECT_EQ(frame->pose(at(7)).translation, pose.translation);
  EXPECT_EQ(frame->twist(at(7)).angular.norm() + frame->twist(at(7)).linear.norm(), 0.0);
}
