#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "loop/linearise.h"
#include "loop/tool_instance.h"
#include "palpate/contact/contact_force.h"
#include "palpate/loop/run.h"
#include "palpate/tool/tool.h"

/// Records of the contact of a tool with reduced bodies, and the ticks that they predict.
namespace palpate::reduced_ticks {

inline constexpr double kPeriod = 0.01;

/// The block under the tool, with its nodes moving at about `speed`.
/// @param spin  angular velocity of the tool about the vertical [rad/s]
inline std::unique_ptr<loop::World> touching(scene::Description d, const std::string& linearisation,
                                             double error = 0.0, double speed = 1e-3, double spin = 0.0) {
  d.exchange.linearisation = linearisation;
  d.exchange.linearisation_error = error;
  d.tool->tick_s = kPeriod;
  auto world = loop::assemble(d);
  contact::TrajectoryFrame& path = *world->tools[0].partitioned()->path;
  const Pose pose = world->tool_pose();
  path.clear();
  path.append(0.0, pose, {Vec3(0, 0, spin), Vec3::Zero()});
  world->contact->refresh(world->state.view());
  VecX u = world->state.u();
  for (Eigen::Index i = 0; i < u.size(); ++i) u[i] += speed * std::sin(1.0 + 7.0 * static_cast<double>(i));
  VecX q = world->state.q();
  world->system.impose(world->state.layout(), 0.0, q.data(), u.data());
  world->state.u() = u;
  return world;
}

/// A wrench and its derivatives by the pose and twist of the tool.
struct Linear {
  Vec6 F;
  Mat6 J, B;
  explicit Linear(const dynamics::LinearisedContact& r)
      : F(Eigen::Map<const Vec6>(r.F0.data())),
        J(Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(r.J.data())),
        B(Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(r.B.data())) {}
};

inline loop::ContactRecord record_of(loop::World& world) {
  long fallbacks = 0;
  const loop::ContactRecord record = loop::linearise_contact(world, 1, kPeriod, fallbacks);
  EXPECT_EQ(fallbacks, 0);
  return record;
}

/// Tolerance of the friction at a tick's end, as tight as Newton's method allows, so that comparisons do not
/// depend on it.
inline constexpr double kSettled = 1e-9;

/// The first tick, with friction at its end, while the tool continues its motion.
inline Linear tick_of(loop::World& world, double length) {
  const loop::ContactRecord record = record_of(world);
  EXPECT_EQ(record.linear.source, dynamics::LinearisedContact::Source::kPoints);
  contact::ReducedContactStepper ticks(world.description.contacts);
  ticks.adopt(record.touch);
  const Pose pose = world.tool_pose();
  const Twist twist = world.tool_twist();
  dynamics::LinearisedContact tick = ticks.linearise(length, length, {pose, twist});
  const dynamics::RigidMotion end{
      {quaternion_of(length * twist.angular) * pose.rotation, pose.translation + length * twist.linear},
      twist};
  while (!ticks.update_friction(end, kSettled)) tick = ticks.relinearise();
  return Linear(tick);
}

/// One tick with the length of the period.
inline Linear whole_tick(loop::World& world) { return tick_of(world, kPeriod); }

inline void expect_same(const Linear& a, const Linear& b, double error) {
  EXPECT_LE((a.F - b.F).tail<3>().norm(), error * b.F.tail<3>().norm());
  const auto of_force = [](const Mat6& m) { return Mat3(m.bottomRightCorner<3, 3>()); };
  EXPECT_LE((of_force(a.J) - of_force(b.J)).norm(), error * of_force(b.J).norm());
  EXPECT_LE((of_force(a.B) - of_force(b.B)).norm(),
            error * (of_force(b.B).norm() + kPeriod * of_force(b.J).norm()));
}

}  // namespace palpate::reduced_ticks
