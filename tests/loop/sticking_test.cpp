// Sticking contact does not drift: friction below its limit is a spring between material points, and friction
// at its limit is Coulomb's.
#include <gtest/gtest.h>

#include <cmath>

#include "loop/small_scenes.h"
#include "palpate/core/named_enum.h"
#include "palpate/loop/run.h"
#include "palpate/loop/world.h"

using namespace palpate;

namespace {

constexpr double kFriction = 0.5;

/// A block of 6 cm on an incline of tan a = ratio times mu.
scene::Description block_on_an_incline(const std::string& integrator, double ratio) {
  const double slope = ratio * kFriction;
  scene::Description d;
  d.name = "incline";
  d.gravity_m_s2 = 9.81 / std::sqrt(1.0 + slope * slope) * Vec3(slope, 0, -1);
  SoftBodySpec block;
  block.name = "block";
  block.mesh.generator = "box";
  block.mesh.size_m = Vec3(0.06, 0.05, 0.02);
  block.mesh.element_size_m = 0.02;
  block.position_m = Vec3(0, 0, 0.00999804);  // in equilibrium
  block.youngs_modulus_pa = 1e6;
  block.stiffness_damping_s = 1e-3;
  d.bodies.push_back(block);
  ContactSpec contact;
  contact.first = "block";
  contact.stiffness_pa_m = 1e8;
  contact.damping_pa_s_m = 1e5;
  contact.friction = kFriction;
  small_scenes::add_floor(d, contact);
  d.contacts[0].method = "auto";
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.01;
  d.integrator.name = integrator;
  d.integrator.step_s = 0.01;
  return d;
}

/// Mean position of the nodes along the slope after `duration_s` [m].
double place(const scene::Description& d, double duration_s) {
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.duration_s = duration_s;
  const loop::RunResult result = loop::run(*world, options);
  EXPECT_TRUE(result.status.ok()) << d.integrator.name << ": " << result.status.message;
  return Eigen::Map<const Points>(world->state.q().data(), 3, world->state.q().size() / 3).row(0).mean();
}

}  // namespace

// Without anchors it creeps at v_r tan a/mu, v_r = 3e-4 sqrt(g L): 2.2 mm in 19 s.
TEST(Sticking, ABlockStaysWhereItCameToRest) {
  for (const auto& [integrator, end_s] :
       {std::pair{"linearly-implicit-euler", 20.0}, std::pair{"backward-euler", 3.0},
        std::pair{"implicit-midpoint", 3.0}, std::pair{"bdf2", 3.0}, std::pair{"newmark", 3.0},
        std::pair{"generalized-alpha", 3.0}, std::pair{"cvode-bdf", 3.0},
        std::pair{"ark-dirk-esdirk436", 3.0}}) {
    scene::Description d = block_on_an_incline(integrator, 0.5);
    const double crept = place(d, end_s) - place(d, 1.0);
    EXPECT_LT(std::abs(crept), 1e-7) << integrator;
  }
  scene::Description d = block_on_an_incline("linearly-implicit-euler", 0.5);
  d.contacts[0].friction_anchors = false;
  EXPECT_NEAR(place(d, 20.0) - place(d, 1.0), 19.0 * 0.5 * 3e-4 * std::sqrt(9.81 * 0.06), 2e-5);
}

// Between two soft bodies as well; the mean of the lower block is used.
TEST(Sticking, ABlockOnABlockIsHeld) {
  scene::Description d = block_on_an_incline("linearly-implicit-euler", 0.5);
  SoftBodySpec upper = d.bodies[0];
  upper.name = "upper";
  upper.position_m.z() += 0.02 - 1e-6;
  d.bodies.push_back(upper);
  ContactSpec between = d.contacts[0];
  between.first = "block";
  between.second = "upper";
  d.contacts.push_back(between);
  EXPECT_LT(std::abs(place(d, 3.0) - place(d, 1.0)), 1e-7);
  d.contacts[1].friction_anchors = false;
  EXPECT_GT(place(d, 3.0) - place(d, 1.0), 5e-5) << "the upper one creeps";
}

#ifdef PALPATE_HAS_TOOL
namespace {

/// A soft block under its weight, between the tools of two hands at rest.
scene::Description held_by_two(const std::string& scheme) {
  scene::Description d;
  d.name = "held by two";
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  SoftBodySpec block;
  block.name = "block";
  block.mesh.generator = "box";
  block.mesh.size_m = Vec3(0.04, 0.04, 0.04);
  block.mesh.element_size_m = 0.01;
  block.density_kg_m3 = 500.0;
  block.youngs_modulus_pa = 3e4;
  block.stiffness_damping_s = 5e-3;
  d.bodies.push_back(block);
  const auto hold = [](double side, ToolSpec& tool, DeviceSpec& device) {
    tool.radius_m = 0.015;
    tool.mass_kg = 0.05;
    tool.position_m = Vec3(side * 0.035, 0, 0);
    tool.coupling = {1000.0, 8.0, 1.0, 0.02};
    KeyframeSpec key;
    key.position_m = Vec3(side * 0.031, 0, 0);
    device.keyframes = {key};
  };
  hold(1.0, d.tool.emplace(), d.device.emplace());
  scene::HandSpec& left = d.hands.emplace_back();
  left.name = "left";
  hold(-1.0, left.tool, left.device);
  for (const char* tool : {"tool", "left"}) {
    ContactSpec contact;
    contact.first = "block";
    contact.second = tool;
    contact.stiffness_pa_m = 1e7;
    contact.friction = 0.8;
    d.contacts.push_back(contact);
  }
  d.exchange.scheme = *value_named<scene::ExchangeScheme>(scheme);
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.005;
  d.integrator.name = "linearly-implicit-euler";
  d.integrator.step_s = 0.005;
  return d;
}

/// Distance that the block sinks from 1 to 2 s, with the hands at rest [m].
double sinks(const scene::Description& d) {
  struct Heights : loop::Observer {
    void period(loop::World& world, double t) override {
      const double z = world.positions(world.bodies[0]).row(2).mean();
      if (t <= 1.0) at_one = z;
      last = z;
    }
    double at_one = 0.0, last = 0.0;
  } heights;
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.duration_s = 2.0;
  options.observers = {&heights};
  const loop::RunResult result = loop::run(*world, options);
  EXPECT_TRUE(result.status.ok()) << result.status.message;
  return heights.at_one - heights.last;
}

}  // namespace

// The block is held by friction below its limit: without anchors it creeps at v_r times the ratio to the
// limit, 30 um/s. With anchors it stays; tools with separate ticks settle from their initial state for half a
// second.
TEST(Sticking, WhatToolsHoldIsHeld) {
  for (const bool partitioned : {true, false}) {
    scene::Description d = held_by_two(partitioned ? "partitioned" : "monolithic");
    EXPECT_LT(std::abs(sinks(d)), partitioned ? 2e-6 : 1e-9) << partitioned;
    for (ContactSpec& contact : d.contacts) contact.friction_anchors = false;
    EXPECT_GT(sinks(d), 2e-5) << partitioned;
  }
}

// Ticks of 10 ms over queries 1 ms apart: the holding force is updated with the ticks. On a stiff block, so
// that nothing else yields.
TEST(Sticking, HoldsInTicksLongerThanTheTimeBetweenQueries) {
  scene::Description d = small_scenes::pressed_block(0.0);
  d.duration_s = 1.0;
  d.bodies[0].youngs_modulus_pa = 1e8;
  d.tool->tick_s = 0.01;
  d.exchange.contact_refresh_s = 0.001;
  d.integrator.step_s = 0.001;
  d.contacts[0].method = "auto";
  d.contacts[0].stiffness_pa_m = 1e8;
  d.contacts[0].friction = 0.5;
  KeyframeSpec key = d.device->keyframes[0];
  const auto go = [&](double t, double x, double z) {
    key.time_s = t;
    key.position_m = d.device->keyframes[0].position_m + Vec3(x, 0, z);
    d.device->keyframes.push_back(key);
  };
  go(0.1, 0.0, -0.003);
  go(0.15, 0.0005, -0.003);
  struct Places : loop::Observer {
    void tick(const loop::TickRecord& tick) override {
      if (tick.time <= 0.7) at = tick.tool.translation;
      last = tick;
    }
    Vec3 at = Vec3::Zero();
    loop::TickRecord last;
  } places;
  loop::RunOptions options;
  options.observers = {&places};
  ASSERT_TRUE(loop::run(*loop::assemble(d), options).status.ok());
  const Vec3& force = places.last.contact.force;
  EXPECT_GT(force.head<2>().norm(), 0.1 * force.z()) << "it has something to hold";
  EXPECT_LT((places.last.tool.translation - places.at).norm(), 1e-7);
}
#endif
