// Reduced contact model with one point and a few modes, and with many points: balances that each tick
// preserves, and behaviour that must not occur.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "reduced_contact.h"

namespace palpate {
namespace {

using namespace contact_tests::reduced_contact;
using contact::ReducedContactModel;
using dynamics::RigidMotion;
using PointModes = Eigen::Matrix<double, 3, kModes>;

/// A wall z = 0 of one square millimetre under a tool's point at the tool's origin, without body response.
ReducedContactModel wall(double gap) {
  ReducedContactModel model;
  model.points = 1;
  model.point[0].normal = {0, 0, 1};
  model.point[0].place = {0, 0, -gap};
  model.point[0].area = 1e-3;
  return model;
}

RigidMotion at(double z, double speed) {
  return {{Quat::Identity(), Vec3(0, 0, z)}, {{}, Vec3(0, 0, speed)}};
}

Vec3 force_at(const dynamics::LinearisedContact& record, double t, const RigidMotion& tool) {
  return dynamics::contact_wrench(record, t, tool.pose, tool.twist).tail<3>();
}

/// Points all over a tool of 2 cm, some deep, some apart, with generic modes.
ReducedContactModel any_model(std::mt19937& random) {
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  const auto vec = [&](double size) {
    return std::array<double, 3>{size * in(random), size * in(random), size * in(random)};
  };
  ReducedContactModel model;
  model.points = 20;
  model.modes = 7;
  Eigen::Map<Eigen::Matrix<double, kModes, kModes>> damping(model.damping.data());
  for (int k = 0; k < model.modes; ++k) {
    model.stiffness[static_cast<std::size_t>(k)] = std::pow(10.0, 3.0 + 0.5 * k);
    model.force[static_cast<std::size_t>(k)] = in(random);
    model.force_rate[static_cast<std::size_t>(k)] = 10.0 * in(random);
    damping(k, k) = 2e-3 * model.stiffness[static_cast<std::size_t>(k)];
  }
  for (int i = 0; i < model.points; ++i) {
    ReducedContactModel::Point& p = model.point[static_cast<std::size_t>(i)];
    const Vec3 normal = Vec3(0.3 * in(random), 0.3 * in(random), 1.0).normalized();
    p.normal = {normal.x(), normal.y(), normal.z()};
    p.offset = vec(0.02);
    p.slide = {-0.01 * normal.x(), -0.01 * normal.y(), -0.01 * normal.z()};
    const Vec3 on_tool = Vec3(p.offset[0], p.offset[1], p.offset[2]) - 0.01 * normal;
    const Vec3 place = on_tool + normal * 1e-3 * (in(random) + 0.5);
    p.place = {place.x(), place.y(), place.z()};
    p.velocity = vec(0.05);
    p.area = 1e-5;
    Eigen::Map<PointModes> modes(p.modes.data());
    for (int k = 0; k < model.modes; ++k) modes.col(k) = Vec3(in(random), in(random), in(random));
  }
  return model;
}

// A tool is torn off at 0.2 m/s: a linear model about the state at the exchange would pull it back.
TEST(ReducedContactStepper, NothingPullsAToolBack) {
  contact::ReducedContactStepper ticks({law()});
  ticks.adopt(wall(-1e-3));
  const double h = 1e-3;
  double largest = 0.0;
  for (int i = 0; i < 10; ++i) {
    const RigidMotion before = at(0.2 * i * h, 0.2), after = at(0.2 * (i + 1) * h, 0.2);
    const auto record = ticks.linearise((i + 1) * h, h, before);
    const double force = force_at(record, (i + 1) * h, after).z();
    EXPECT_GE(force, 0.0);
    largest = std::max(largest, force);
    EXPECT_EQ(ticks.pressing(), after.pose.translation.z() < 1e-3 - 1e-12 ? 1 : 0);
    ticks.follow(after);
  }
  EXPECT_GT(largest, 0.5);  // initially 1 N
}

TEST(ReducedContactStepper, ATouchWithinThePeriodIsFeltInItsTick) {
  contact::ReducedContactStepper ticks({law()});
  ticks.adopt(wall(1e-3));
  const double h = 1e-3;
  for (int i = 0; i < 10; ++i) {
    const RigidMotion before = at(-0.3 * i * h, -0.3), after = at(-0.3 * (i + 1) * h, -0.3);
    const auto record = ticks.linearise((i + 1) * h, h, before);
    const double under = -after.pose.translation.z() - 1e-3;
    const double expected = under > 0.0 ? 1e-3 * (1e6 * under + 1e2 * 0.3) : 0.0;
    EXPECT_NEAR(force_at(record, (i + 1) * h, after).z(), expected, 1e-9);
    ticks.follow(after);
  }
}

// 30 N on the skin at 0.1 m/s: friction never exceeds mu times the pressure.
TEST(ReducedContactStepper, FrictionStaysInItsCone) {
  contact::ReducedContactStepper ticks({law(0.3)});
  ReducedContactModel model = wall(-1e-3);
  ticks.adopt(model);
  const double h = 1e-3, speed = 0.1;
  for (int i = 0; i < 10; ++i) {
    RigidMotion before = at(0.0, 0.0), after = before;
    before.pose.translation.x() = speed * i * h;
    after.pose.translation.x() = speed * (i + 1) * h;
    before.twist.linear = after.twist.linear = Vec3(speed, 0, 0);
    const Vec3 force = force_at(ticks.linearise((i + 1) * h, h, before), (i + 1) * h, after);
    EXPECT_NEAR(force.z(), 1.0, 1e-9);
    EXPECT_NEAR(force.x(), -0.3, 1e-9);
    ticks.follow(after);
  }
}

// A free tool at rest is pushed with 1.01 to 3 times the limit of sticking: from its first tick on it slides
// as the law predicts, with the force on the cone. Once slowed down it comes to rest and remains there.
TEST(ReducedContactStepper, AToolThatStartsToSlideFeelsNoMoreThanTheCone) {
  const double h = 1e-3, mass = 0.05, mu = 0.3;
  for (const double push : {1.01, 1.5, 3.0}) {
    contact::ReducedContactStepper ticks({law(mu)});
    ticks.adopt(wall(-1e-3));
    RigidMotion tool = at(0.0, 0.0);
    const auto end_of = [&](const dynamics::LinearisedContact& record, double pushed) {
      using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
      const double by_dv = (h * Eigen::Map<const RowMajor6>(record.J.data()) +
                            Eigen::Map<const RowMajor6>(record.B.data()))(3, 3);
      RigidMotion end = tool;
      end.twist.linear.x() += h * (record.F0[3] + pushed) / (mass - h * by_dv);
      end.pose.translation.x() += h * end.twist.linear.x();
      return end;
    };
    const auto tick = [&](int i, double pushed) {
      auto record = ticks.linearise((i + 1) * h, h, tool);
      while (!ticks.update_friction(end_of(record, pushed))) record = ticks.relinearise();
      tool = end_of(record, pushed);
      ticks.follow(tool);
      return force_at(record, (i + 1) * h, tool);
    };
    for (int i = 0; i < 50; ++i) {
      const Vec3 force = tick(i, push * mu);
      EXPECT_LE(force.head<2>().norm(), 1.001 * mu * force.z()) << push << ", tick " << i;
    }
    const double slid = (push - 1.0) * mu / mass * 50 * h;
    EXPECT_NEAR(tool.twist.linear.x(), slid, 0.01 * slid + 1e-3) << push;  // v_r = 1e-3
    for (int i = 50; i < 400; ++i) tick(i, 0.0);
    EXPECT_LT(std::abs(tool.twist.linear.x()), 1e-3) << push;
  }
}

// One mass on a spring under one point: the two equations of a tick by hand.
TEST(ReducedContactStepper, OneMassAnswersByImplicitEuler) {
  ReducedContactModel model = wall(-1e-3);
  const double m = 0.01, k = 5000.0, h = 1e-3;  // stiff enough to stay in contact
  model.modes = 1;
  model.stiffness[0] = k / m;
  model.point[0].modes[2] = 1.0 / std::sqrt(m);
  contact::ReducedContactStepper ticks({law()});
  ticks.adopt(model);
  double x = 0.0, v = 0.0;
  const double kc = 1e-3 * 1e6, dc = 1e-3 * 1e2;
  for (int i = 0; i < 50; ++i) {
    const RigidMotion still = at(0.0, 0.0);
    const auto record = ticks.linearise((i + 1) * h, h, still);
    const double force = force_at(record, (i + 1) * h, still).z();
    ticks.follow(still);
    // m (v1 - v) = h (-k (x + h v1) - kc (1e-3 + x + h v1) - dc v1), while it presses
    v = (m * v - h * (k * x + kc * (1e-3 + x))) / (m + h * h * (k + kc) + h * dc);
    x += h * v;
    EXPECT_NEAR(force, kc * (1e-3 + x) + dc * v, 1e-9) << i;
  }
  EXPECT_NEAR(x, -kc * 1e-3 / (k + kc), 1e-4);
}

/// The same point, held by a grasp where it touches.
ReducedContactModel held(double gap) {
  ReducedContactModel model = wall(gap);
  model.point[0].held_stiffness = 1e6 * model.point[0].area;
  model.point[0].held_damping = 1e2 * model.point[0].area;
  return model;
}

// Pulled away, a held point is a spring to its anchor; pressed, it holds along the surface only.
TEST(ReducedContactStepper, AHeldPointPullsBack) {
  contact::ReducedContactStepper ticks({law()});
  ticks.adopt(held(0.0));
  const double h = 1e-3;
  for (const double z : {-1e-3, 2e-3}) {
    RigidMotion tool = at(z, 0.0);
    tool.pose.translation.x() = 3e-3;
    tool.twist.linear = Vec3(0.1, 0.0, 0.2);
    const auto record = ticks.linearise(h, h, tool);
    tool.pose.translation += h * tool.twist.linear;
    const Vec3 force = force_at(record, h, tool), x = tool.pose.translation;
    EXPECT_NEAR(force.x(), -1e3 * x.x() - 0.1 * 0.1, 1e-7);
    EXPECT_NEAR(force.z(), z > 0.0 ? -1e3 * x.z() - 0.1 * 0.2 : 0.0, 1e-7);
  }
}

TEST(ReducedContactStepper, OneHeldMassAnswersByImplicitEuler) {
  ReducedContactModel model = held(-1e-3);
  model.point[0].normal = {0, 0, -1};  // the point is pulled
  const double m = 0.01, k = 5000.0, h = 1e-3, kc = 1e3, dc = 0.1;
  model.modes = 1;
  model.stiffness[0] = k / m;
  model.point[0].modes[2] = 1.0 / std::sqrt(m);
  contact::ReducedContactStepper ticks({law()});
  ticks.adopt(model);
  double x = 0.0, v = 0.0;
  for (int i = 0; i < 50; ++i) {
    const RigidMotion still = at(0.0, 0.0);
    const auto record = ticks.linearise((i + 1) * h, h, still);
    const double force = force_at(record, (i + 1) * h, still).z();
    ticks.follow(still);
    v = (m * v - h * (k * x + kc * (1e-3 + x))) / (m + h * h * (k + kc) + h * dc);
    x += h * v;
    EXPECT_NEAR(force, kc * (1e-3 + x) + dc * v, 1e-9) << i;
  }
}

// Without body response, the record is linear in the tool's pose, including rotated arms.
TEST(ReducedContactStepper, HeldPointsAreLinearInTheToolsPose) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  ReducedContactModel model = any_model(random);
  model.modes = 0;
  for (auto& point : model.point) {
    point.modes = {};
    point.velocity = {};
    point.held_stiffness = 10.0;
  }
  contact::ReducedContactStepper ticks({law()});
  ticks.adopt(model);
  const double h = 1e-3;
  const RigidMotion tool{{quaternion_of(Vec3(0.3, 0.2, -0.4)), Vec3(0.001, 0.002, 0.03)}, {}};
  const auto record = ticks.linearise(h, h, tool);
  Vec6 d;
  for (double& one : d) one = in(random);
  std::vector<double> errors;
  for (const double step : {1e-3, 5e-4, 2.5e-4}) {
    const RigidMotion moved{{quaternion_of(step * d.head<3>()) * tool.pose.rotation,
                             tool.pose.translation + 0.02 * step * d.tail<3>()},
                            {}};
    const auto there = ticks.linearise(h, h, moved);
    const Vec6 linear = dynamics::contact_wrench(record, h, moved.pose, moved.twist);
    errors.push_back((Eigen::Map<const Vec6>(there.F0.data()) - linear).norm());
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2.0, 0.1);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2.0, 0.1);
}

// Bodies are pushed within a tick: the wrench is the one at their final positions, including the moment of
// the rotated arms, up to second order in their displacement.
TEST(ReducedContactStepper, HeldPointsAreWhereTheBodiesCome) {
  std::vector<double> errors;
  for (const double push : {1.0, 0.5, 0.25}) {
    std::mt19937 random(6);
    ReducedContactModel model = any_model(random);
    for (std::size_t k = 0; k < 7; ++k)
      model.force[k] = push * (k % 2 ? 50.0 : -40.0), model.force_rate[k] = 0;
    for (auto& point : model.point) {
      point.velocity = {};
      point.offset[2] -= 0.05;  // pressed or pulled, each point keeps its state
      point.held_stiffness = 10.0;
    }
    contact::ReducedContactStepper ticks({law()});
    ticks.adopt(model);
    const double h = 1e-3, none = 1e-12;
    const RigidMotion tool{};
    const auto before = ticks.linearise(h, h, tool);
    ticks.follow(tool);
    const auto after = ticks.linearise(h + none, none, tool);
    errors.push_back(
        (Eigen::Map<const Vec6>(before.F0.data()) - Eigen::Map<const Vec6>(after.F0.data())).norm());
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2.0, 0.2);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2.0, 0.2);
}

// A non-rotating tool collides with a free body, with friction: wherever points press, the tool loses the
// momentum that the body gains, in each tick.
void expect_momentum_kept(bool grasped) {
  std::mt19937 random(4);
  const double h = 1e-3, tool_mass = 0.05, body_mass = 0.2;
  ReducedContactModel model = any_model(random);
  model.modes = 3;
  model.stiffness = {};
  model.damping = {};
  model.force = {};
  model.force_rate = {};
  for (auto& point : model.point) {
    point.velocity = {};
    point.modes = {};
    for (int k = 0; k < 3; ++k) point.modes[static_cast<std::size_t>(4 * k)] = 1.0 / std::sqrt(body_mass);
  }
  for (std::size_t i = 0; grasped && i < 20; i += 2) {
    model.point[i].held_stiffness = 10.0;
    model.point[i].held_damping = 1e-3;
  }
  contact::ReducedContactStepper ticks({law(0.4)});
  ticks.adopt(model);
  RigidMotion tool{{}, {Vec3::Zero(), Vec3(0.1, -0.05, -0.2)}};
  const Vec3 total = tool_mass * tool.twist.linear;
  double pressed = 0.0;
  for (int i = 0; i < 40; ++i) {
    const auto record = ticks.linearise((i + 1) * h, h, tool);
    pressed += ticks.pressing();
    using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
    const Mat6 J = Eigen::Map<const RowMajor6>(record.J.data()),
               B = Eigen::Map<const RowMajor6>(record.B.data());
    // m dv = h F, F = F0 + J (h dv) + B dv: x0 is the tool's final position for dv = 0
    const Mat3 by_dv = (h * J + B).bottomRightCorner<3, 3>();
    const Vec3 dv = (tool_mass * Mat3::Identity() - h * by_dv)
                        .partialPivLu()
                        .solve(h * Eigen::Map<const Vec6>(record.F0.data()).tail<3>());
    tool.twist.linear += dv;
    tool.pose.translation += h * tool.twist.linear;
    ticks.follow(tool);
    const Vec3 body = std::sqrt(body_mass) * ticks.rates().head<3>();
    EXPECT_LE((tool_mass * tool.twist.linear + body - total).norm(), 1e-13) << i;
  }
  EXPECT_GT(pressed, 40.0);
  if (grasped) return;
  EXPECT_GT(tool.twist.linear.z(), 0.01);  // it bounced
}

TEST(ReducedContactStepper, ToolAndBodiesKeepTheirMomentum) {
  expect_momentum_kept(false);
  expect_momentum_kept(true);
}

}  // namespace
}  // namespace palpate
