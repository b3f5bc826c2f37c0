// A soft tool: the hand's tool carries nodes of a soft body, at a thousand ticks per second all the same.
#include <gtest/gtest.h>

#include "loop/body_loop.h"
#include "loop/coupling/carried_bodies.h"
#include "loop/small_scenes.h"
#include "loop/ticks_of.h"
#include "loop/tool_instance.h"
#include "palpate/contact/contact_force.h"
#include "palpate/core/error.h"
#include "palpate/core/named_enum.h"
#include "palpate/loop/run.h"

namespace {

using namespace palpate;

/// A block whose upper face is carried by a tool, with its handle at rest.
scene::Description carried_block() {
  scene::Description d = small_scenes::pressed_block(0.0);
  d.contacts.clear();
  d.bodies[0].mesh.element_size_m = 0.005;
  d.bodies[0].attachments[0].to = "tool";
  d.bodies[0].attachments[0].region = Selection::kBox;
  d.bodies[0].attachments[0].box_min_m = Vec3(-1, -1, 0.019);
  d.bodies[0].attachments[0].box_max_m = Vec3(1, 1, 0.021);
  d.tool->coupling.rotational_stiffness_n_m_rad = 1.0;
  d.tool->coupling.rotational_damping_n_m_s_rad = 5e-3;
  d.device->max_force_n = 50.0;
  d.device->max_torque_n_m = 5.0;
  return d;
}

double mass_of(const scene::Description& d) { return d.bodies[0].density_kg_m3 * 0.04 * 0.04 * 0.02; }

// A body hanging from the tool exerts m g on the hand, and a moment of m g times the distance to its centre.
TEST(SoftTool, WeighsWhatItWeighs) {
  for (const char* linearisation : {"points", "condensed", "monolithic", "single_rate"}) {
    scene::Description d = carried_block();
    d.duration_s = 1.0;
    d.gravity_m_s2 = Vec3(0, 0, -9.81);
    d.bodies[0].mass_damping_per_s = 20.0;  // damped to rest
    if (const auto scheme = value_named<scene::ExchangeScheme>(linearisation))
      d.exchange.scheme = *scheme;
    else
      d.exchange.linearisation = linearisation;
    const auto world = loop::assemble(d);
    const auto ticks = ticks_of(*world);
    const double weight = 9.81 * mass_of(d);
    const loop::TickRecord& still = ticks.back();
    EXPECT_NEAR(still.device.force.z(), -weight, 2e-3 * weight) << linearisation;
    EXPECT_LE(still.device.force.head<2>().norm(), 2e-3 * weight) << linearisation;
    // the tool is 1 mm and 2 mm off the block's centre, which hangs sideways because of the tissue's softness
    EXPECT_NEAR(still.device.moment.x(), 0.002 * weight, 5e-5 * weight) << linearisation;
    EXPECT_NEAR(still.device.moment.y(), -0.001 * weight, 5e-5 * weight) << linearisation;
  }
}

/// The block is swung sideways and down, and pressed onto the floor on its way.
scene::Description swung_block() {
  scene::Description d = carried_block();
  d.duration_s = 0.3;
  d.bodies[0].youngs_modulus_pa = 2e4;
  d.bodies[0].mesh.element_size_m = 0.01;
  ContactSpec law;
  law.first = "block";
  law.stiffness_pa_m = 1e7;
  law.damping_pa_s_m = 1e4;
  law.onset_width_m = 1e-4;
  d.bodies[0].position_m.z() += 0.002;
  d.bodies[0].attachments[0].box_min_m.z() += 0.002;
  d.bodies[0].attachments[0].box_max_m.z() += 0.002;
  d.tool->position_m.z() += 0.002;
  small_scenes::add_floor(d, law);
  d.device->keyframes[0].position_m = d.tool->position_m;
  for (const auto& [t, x, z] : {std::tuple{0.1, 0.01, 0.0}, {0.2, 0.02, -0.004}, {0.3, 0.02, -0.004}}) {
    KeyframeSpec next;
    next.time_s = t;
    next.position_m = d.tool->position_m + Vec3(x, 0.0, z);
    d.device->keyframes.push_back(next);
  }
  return d;
}

std::vector<loop::TickRecord> swung(double period) {
  scene::Description d = swung_block();
  d.integrator.step_s = d.exchange.exchange_period_s = d.exchange.contact_refresh_s = period;
  d.tool->tick_s = 5e-4;
  return ticks_of(*loop::assemble(d));
}

// The force on the hand is that of the monolithic solution in which the tool carries the nodes rigidly: the
// block's inertia while it swings, and the floor through the block. The difference decreases with the period.
TEST(SoftTool, FeelsAsOneSystem) {
  scene::Description d = swung_block();
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  d.integrator.name = "implicit-midpoint";
  d.integrator.step_s = d.exchange.contact_refresh_s = 2.5e-4;
  d.exchange.exchange_period_s = d.tool->tick_s = 5e-4;
  const auto truth = ticks_of(*loop::assemble(d));
  double peak = 0.0, before = 0.15;
  for (const loop::TickRecord& tick : truth) peak = std::max(peak, tick.device.force.norm());
  EXPECT_GT(peak, 0.3);
  for (const double period : {0.01, 0.005, 0.0025}) {
    const auto ticks = swung(period);
    ASSERT_EQ(ticks.size(), truth.size());
    double square = 0.0;
    for (std::size_t i = 0; i < ticks.size(); ++i)
      square += (ticks[i].device.force - truth[i].device.force).squaredNorm();
    const double rms = std::sqrt(square / static_cast<double>(ticks.size()));
    EXPECT_LE(rms / peak, 0.75 * before) << period;
    before = rms / peak;
  }
  EXPECT_LE(before, 0.05);
}

// A grasp switch does not release what the tool carries.
TEST(SoftTool, AGraspDoesNotLetItGo) {
  scene::Description d = carried_block();
  d.duration_s = 0.3;
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  d.tool->grasp_switch = 2;
  d.device->presses = {{2, 0.05, 0.1}};
  const auto world = loop::assemble(d);
  const auto ticks = ticks_of(*world);
  EXPECT_EQ(world->contact->statistics().grasps.points, 0);
  EXPECT_EQ(world->contact->statistics().grasps.area, 0.0);
  EXPECT_NEAR(world->positions(world->bodies[0]).row(2).mean(), 0.01, 5e-3) << "it hangs where it did";
}

// Each hand carries its body.
TEST(SoftTool, ASecondHandCarriesToo) {
  for (const char* scheme : {"partitioned", "monolithic", "single_rate"}) {
    scene::Description d = carried_block();
    d.duration_s = 0.5;
    d.gravity_m_s2 = Vec3(0, 0, -9.81);
    d.bodies[0].mass_damping_per_s = 20.0;
    d.exchange.scheme = *value_named<scene::ExchangeScheme>(scheme);
    scene::HandSpec left;
    left.name = "left";
    left.tool = *d.tool;
    left.device = *d.device;
    d.tool->position_m.x() += 1.0;  // far from the first one
    d.device->keyframes[0].position_m = d.tool->position_m;
    d.hands.push_back(left);
    d.bodies[0].attachments[0].to = "left";
    struct Both : loop::Observer {
      void tick_of(std::size_t hand, const loop::TickRecord& tick) override { last[hand] = tick; }
      loop::TickRecord last[2];
    } both;
    loop::RunOptions options;
    options.observers = {&both};
    ASSERT_TRUE(loop::run(*loop::assemble(d), options).status.ok());
    EXPECT_NEAR(both.last[1].device.force.z(), -9.81 * mass_of(d), 0.01 * 9.81 * mass_of(d)) << scheme;
    EXPECT_LE(both.last[0].device.force.norm(), 1e-9) << scheme;
  }
}

// While the bodies are held, the body carried by the tool moves with it: nothing is torn.
TEST(SoftTool, TakesItsBodyAlong) {
  scene::Description d = carried_block();
  SoftBodySpec other = d.bodies[0];
  other.name = "other";
  other.position_m.x() += 1.0;
  other.attachments.clear();
  d.bodies.push_back(other);
  const auto world = loop::assemble(d);
  const Pose before = world->tool_pose();
  const Twist twist{Vec3(0.1, 0.2, -0.3), Vec3(0.4, 0.0, 0.1)};
  VecX u = world->state.u();
  for (Eigen::Index i = 0; i < u.size(); ++i) u[i] = 0.01 * std::sin(1.0 + 7.0 * static_cast<double>(i));
  world->state.u() = u;
  const Points x = world->positions(world->bodies[0]), y = world->positions(world->bodies[1]);
  const Pose moved{Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())) * before.rotation,
                   before.translation + Vec3(0.05, -0.03, 0.02)};
  const Twist twist_now{Vec3(-1, 2, 0.5), Vec3(0.1, -0.2, 0.3)};
  loop::carry_along(world->state, world->tools[0].partitioned()->ties, {before, twist}, {moved, twist_now});
  const Points now = world->positions(world->bodies[0]);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vec3 place = before.inverse() * Vec3(x.col(i));
    EXPECT_LT((moved.inverse() * Vec3(now.col(i)) - place).norm(), 1e-15);
    const Vec3 against = before.rotation.conjugate() *
                         (u.segment<3>(3 * i) - twist.at(Vec3(x.col(i)) - before.translation)),
               still = moved.rotation.conjugate() * (Vec3(world->state.u().segment<3>(3 * i)) -
                                                     twist_now.at(Vec3(now.col(i)) - moved.translation));
    EXPECT_LT((still - against).norm(), 1e-14);
  }
  EXPECT_EQ(world->positions(world->bodies[1]), y) << "it carries that one alone";
}

// As in the real-time loop with late bodies.
TEST(SoftTool, TakesItsBodyAlongWhereItIsLate) {
  const auto world = loop::assemble(carried_block());
  loop::RunOptions options;
  loop::RunResult result;
  loop::BodyLoop bodies(*world, options, result);
  bodies.restart_path();
  const Pose before = world->tool_pose();
  const Points x = world->positions(world->bodies[0]);
  const Vec3 way(0.03, -0.01, 0.02);
  bodies.follow(0, 0.5, {before.rotation, before.translation + way}, {});
  bodies.hold_bodies(0.5);
  EXPECT_EQ(world->state.time(), 0.5);
  EXPECT_LT((world->positions(world->bodies[0]) - (x.colwise() + way)).norm(), 1e-14);
}

}  // namespace
