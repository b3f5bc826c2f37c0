// A rigid tool against obstacles, through a whole scene.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "palpate/core/error.h"
#include "palpate/core/named_enum.h"
#include "palpate/loop/run.h"
#include "small_scenes.h"

#ifdef PALPATE_HAS_TOOL

using namespace palpate;

namespace {

constexpr double kR = 0.02, kMass = 0.1, kG = 9.81;

struct Ticks final : loop::Observer {
  std::vector<loop::TickRecord> ticks;
  void tick(const loop::TickRecord& tick) override { ticks.push_back(tick); }
};

/// A ball without a hand (its coupling has no spring), `gap` above an obstacle whose top is at z = 0.
scene::Description ball_over(const std::string& type, double gap) {
  scene::Description d;
  d.name = "ball over " + type;
  d.duration_s = 0.5;
  d.gravity_m_s2 = Vec3(0, 0, -kG);
  d.tool.emplace();
  d.tool->radius_m = kR;
  d.tool->mass_kg = kMass;
  d.tool->gravity = true;
  d.tool->position_m = Vec3(0, 0, kR + gap);
  d.tool->coupling = {0.0, 0.0, 0.0, 0.0};
  d.device.emplace();
  KeyframeSpec hold;
  hold.position_m = d.tool->position_m;
  d.device->keyframes.push_back(hold);
  ObstacleSpec ground;
  ground.name = "ground";
  ground.type = type;
  if (type == "sphere") ground.shape = {{"radius_m", 0.05}, {"position_m", Vec3(0, 0, -0.05)}};
  if (type == "box") ground.shape = {{"size_m", Vec3(0.2, 0.2, 0.06)}, {"position_m", Vec3(0, 0, -0.03)}};
  if (type == "cylinder")
    ground.shape = {{"radius_m", 0.04},
                    {"length_m", 0.3},
                    {"position_m", Vec3(0, 0, -0.04)},
                    {"rotation_vector_rad", Vec3(0, 0.5 * std::numbers::pi, 0)}};
  d.obstacles.push_back(ground);
  ContactSpec contact;
  contact.first = "tool";
  contact.second = "ground";
  contact.stiffness_pa_m = 1e8;
  contact.law = "hunt_crossley";
  contact.hunt_crossley_s_m = 30.0;
  d.contacts.push_back(contact);
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 5e-3;
  d.integrator.name = "linearly-implicit-euler";
  d.integrator.step_s = 1e-3;
  return d;
}

std::vector<loop::TickRecord> run(const scene::Description& d, const Vec3& velocity = Vec3::Zero(),
                                  loop::RunResult* result = nullptr) {
  const auto world = loop::assemble(d);
  if (!velocity.isZero()) {
    EXPECT_TRUE(world->monolithic()) << "a tool of ticks begins at rest";
    world->state.u().tail<3>() = velocity;
  }
  Ticks keep;
  loop::RunOptions options;
  options.observers = {&keep};
  const loop::RunResult out = loop::run(*world, options);
  EXPECT_TRUE(out.status.ok()) << out.status.message;
  if (result) *result = out;
  return keep.ticks;
}

}  // namespace

// A hand drags a block over a plane, with increasing speed, back, and sideways: whether it sticks, starts to
// slide, reverses or comes to rest, the force is within the cone of friction at every tick.
TEST(ToolOnObstacle, NoTickIsOutsideTheConeOfFriction) {
  constexpr double kMu = 0.3;
  scene::Description d = ball_over("plane", 0.0);
  d.tool->shape = ToolShape::kMesh;
  d.tool->mesh.generator = "box";
  d.tool->mesh.size_m = Vec3::Constant(2.0 * kR);
  d.tool->mesh.element_size_m = kR;
  d.tool->inertia_kg_m2 = Vec3::Constant(kMass * 4.0 * kR * kR / 6.0);
  d.tool->coupling = {200.0, 1.0, 0.5, 2e-3};
  d.contacts[0].stiffness_pa_m = 1e7;
  d.contacts[0].friction = kMu;
  const auto go = [&](double t, double x, double y) {
    KeyframeSpec key;
    key.time_s = t;
    key.position_m = d.tool->position_m + Vec3(x, y, -1e-3);
    d.device->keyframes.push_back(key);
  };
  go(0.1, 0.0, 0.0);
  go(0.17, 0.02, 0.0);
  go(0.25, -0.01, 0.0);
  go(0.35, 0.0, 0.02);
  go(0.45, 0.0, 0.02);
  int sticks = 0, slides = 0;
  for (const loop::TickRecord& tick : run(d)) {
    const Vec3& force = tick.contact.force;
    const double limit = kMu * force.z(), along = force.head<2>().norm();
    EXPECT_LE(along, 1.001 * limit + 1e-12) << tick.time;
    sticks += along < 0.9 * limit;
    slides += along > 0.998 * limit && limit > 0.0;
  }
  EXPECT_GT(sticks, 50);
  EXPECT_GT(slides, 50);
}

TEST(ToolOnObstacle, AtRestItCarriesItsWeight) {
  int checked = 0;
  for (const char* type : {"plane", "sphere", "box", "cylinder"})
    for (const char* scheme : {"partitioned", "monolithic", "single_rate"})
      for (const bool mesh : {false, true}) {
        scene::Description d = ball_over(type, 2e-4);
        d.exchange.scheme = *value_named<scene::ExchangeScheme>(scheme);
        if (mesh && std::string(type) != "plane") continue;  // facets do not balance on a round obstacle
        if (mesh) {
          d.tool->shape = ToolShape::kMesh;
          d.tool->mesh.generator = "box";
          d.tool->mesh.size_m = Vec3::Constant(2.0 * kR);
          d.tool->mesh.element_size_m = kR;
          d.tool->inertia_kg_m2 = Vec3::Constant(kMass * 4.0 * kR * kR / 6.0);
          d.contacts[0].stiffness_pa_m = 1e7;
        }
        const auto ticks = run(d);
        ASSERT_GT(ticks.size(), 400u);
        const std::string what = std::string(type) + ", " + scheme + (mesh ? ", mesh" : "");
        EXPECT_NEAR(ticks.back().contact.force.z() / (kMass * kG), 1.0, 1e-3) << what;
        EXPECT_LT(ticks.back().tool_twist.linear.norm(), 1e-4) << what;
        EXPECT_LT(ticks.back().contact.force.head<2>().norm(), 1e-6 * kMass * kG) << what;
        if (std::string(type) ==
            "plane") {  // at the depth at which k times the integrated depth equals the weight
          const double depth = kR - ticks.back().tool.translation.z(),
                       force = mesh ? 1e7 * 4.0 * kR * depth * (kR + depth)  // includes its sides
                                    : 1e8 * std::numbers::pi * kR * depth * depth;
          EXPECT_NEAR(force / (kMass * kG), 1.0, 2e-3) << what;
        }
        ++checked;
      }
  EXPECT_EQ(checked, 15);
}

// k pi R d^2 is the gradient of an energy: the ball leaves at its impact speed with the opposite momentum,
// and the contact has transferred twice that.
TEST(ToolOnObstacle, WithoutDampingItBouncesBackAsFast) {
  scene::Description d = ball_over("plane", 1e-3);
  d.gravity_m_s2.setZero();
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  d.exchange.contact_refresh_s = 1e-3;
  d.contacts[0].hunt_crossley_s_m = 0.0;
  d.contacts[0].stiffness_pa_m = 1e8;
  d.duration_s = 0.02;
  d.tool->tick_s = 1e-4;
  d.integrator.name = "cvode-bdf";
  d.integrator.rtol = 1e-8;
  const auto ticks = run(d, Vec3(0.05, 0, -0.5));
  const Vec3 after = ticks.back().tool_twist.linear;
  EXPECT_GT(ticks.back().tool.translation.z(), kR) << "it has left";
  EXPECT_NEAR(after.z(), 0.5, 2e-4);
  EXPECT_NEAR(after.x(), 0.05, 1e-9);
  double impulse = 0.0, deepest = 0.0;
  for (const auto& tick : ticks) {
    impulse += d.tool->tick_s * tick.contact.force.z();
    deepest = std::max(deepest, kR - tick.tool.translation.z());
  }
  EXPECT_NEAR(impulse / (2.0 * kMass * 0.5), 1.0, 1e-2);
  const double energy = 1e8 * std::numbers::pi * std::pow(deepest, 3) * kR / 3.0;
  EXPECT_NEAR(energy / (0.5 * kMass * 0.25), 1.0, 5e-3);
}

// Hunt and Crossley: G(a v0) = G(-e a v0), G(u) = u - ln(1 + u), a = 3 c/2; for a v0 = 1, e = 0.593624.
TEST(ToolOnObstacle, HuntAndCrossleysRestitution) {
  scene::Description d = ball_over("plane", 1e-3);
  d.gravity_m_s2.setZero();
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  d.exchange.contact_refresh_s = 1e-3;
  d.contacts[0].hunt_crossley_s_m = 2.0 / 3.0 / 0.5;
  d.duration_s = 0.02;
  d.integrator.name = "cvode-bdf";
  d.integrator.rtol = 1e-8;
  EXPECT_NEAR(run(d, Vec3(0, 0, -0.5)).back().tool_twist.linear.z() / 0.5, 0.593624, 5e-4);
}

// A falling ball in ticks: its rebound converges to the monolithic solution at first order in the tick.
TEST(ToolOnObstacle, TicksTendToOneSystem) {
  scene::Description d = ball_over("plane", 0.01);
  d.contacts[0].hunt_crossley_s_m = 0.5;
  d.contacts[0].stiffness_pa_m = 1e7;
  d.duration_s = 0.08;
  scene::Description one = d;
  one.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  one.exchange.contact_refresh_s = 1e-3;
  one.integrator.name = "cvode-bdf";
  one.integrator.rtol = 1e-8;
  const double exact = run(one).back().tool_twist.linear.z();
  EXPECT_GT(exact, 0.1) << "on its way up";
  double error[2];
  for (int i = 0; i < 2; ++i) {
    d.tool->tick_s = i == 0 ? 1e-4 : 5e-5;
    error[i] = std::abs(run(d).back().tool_twist.linear.z() - exact);
  }
  EXPECT_LT(error[0], 0.05 * exact);
  EXPECT_NEAR(std::log2(error[0] / error[1]), 1.0, 0.3) << error[0] << ", " << error[1];
}

// A ball set down while sliding: v = v0 - mu g t, and it begins to spin at w = 5/2 mu g t / R (arm R - d).
TEST(ToolOnObstacle, FrictionSlowsAndSpinsASlidingBall) {
  scene::Description d = ball_over("plane", 0.0);
  const double depth = std::sqrt(kMass * kG / (1e8 * std::numbers::pi * kR));
  d.tool->position_m.z() = kR - depth;
  d.device->keyframes[0].position_m = d.tool->position_m;
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  d.exchange.contact_refresh_s = 1e-3;
  d.contacts[0].friction = 0.3;
  d.integrator.step_s = 1e-4;
  d.duration_s = 0.05;
  const auto ticks = run(d, Vec3(1.0, 0, 0));
  const double slowed = 0.3 * kG * d.duration_s;
  EXPECT_NEAR((1.0 - ticks.back().tool_twist.linear.x()) / slowed, 1.0, 5e-3);
  EXPECT_NEAR(ticks.back().tool_twist.angular.y() / (2.5 * slowed / kR), 1.0, 1e-2);
}

// A period that is long relative to the fall: contact that occurs within it is among the candidates.
TEST(ToolOnObstacle, WhatComesWithinAPeriodIsLookedAheadFor) {
  for (const char* scheme : {"partitioned", "monolithic", "single_rate"}) {
    scene::Description d = ball_over("plane", 0.06);  // 1 cm apart at the last query before contact
    d.exchange.scheme = *value_named<scene::ExchangeScheme>(scheme);
    d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.02;
    d.contacts[0].hunt_crossley_s_m = 3.0;
    d.duration_s = 0.3;
    double lowest = 1.0;
    for (const auto& tick : run(d)) lowest = std::min(lowest, tick.tool.translation.z());
    // 1.1 m/s: without friction or damping the depth is (3 m v^2/(2 pi k R))^(1/3)
    EXPECT_GT(lowest,
              kR - 1.5 * std::cbrt(3.0 * kMass * 2.0 * kG * 0.06 / (2.0 * std::numbers::pi * 1e8 * kR)))
        << scheme;
  }
}

namespace {

/// The block between the tool and a floor, with a post that stops the tool.
scene::Description squeezed(const char* scheme, const char* linearisation) {
  scene::Description d = small_scenes::pressed_block(0.002);
  d.exchange.scheme = *value_named<scene::ExchangeScheme>(scheme);
  d.exchange.linearisation = linearisation;
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 5e-3;
  ContactSpec law;
  law.first = "block";
  law.stiffness_pa_m = 1e7;
  small_scenes::add_floor(d, law);
  ContactSpec stop;
  stop.first = "tool";
  stop.second = "stop";
  stop.stiffness_pa_m = 1e8;
  ObstacleSpec post;
  post.name = "stop";
  post.type = "box";  // the tool's lowest point penetrates the block by 1 mm, then this post by 0.5 mm
  post.shape = {{"size_m", Vec3(0.01, 0.01, 0.02)}, {"position_m", Vec3(0.001, 0.002, 0.0085)}};
  d.obstacles.push_back(post);
  d.contacts.push_back(stop);
  d.integrator.step_s = 5e-3;
  d.duration_s = 0.4;
  return d;
}

}  // namespace

// The tick's wrench is the sum over both partners; frozen and condensed reach the same equilibrium.
TEST(ToolOnObstacle, BesideASoftBody) {
  double force[3], depth[3];
  int i = 0;
  for (const auto& [scheme, linearisation] :
       {std::pair{"partitioned", "frozen"}, {"partitioned", "condensed"}, {"monolithic", "frozen"}}) {
    scene::Description d = squeezed(scheme, linearisation);
    const auto ticks = run(d);
    force[i] = ticks.back().contact.force.z();
    depth[i] = d.tool->position_m.z() - ticks.back().tool.translation.z();
    EXPECT_LT(ticks.back().tool_twist.linear.norm(), 1e-4) << scheme << ", " << linearisation;
    // the coupling balances the contact force
    EXPECT_NEAR(force[i], -300.0 * depth[i], 2e-3 * std::abs(force[i])) << scheme << ", " << linearisation;
    ++i;
  }
  EXPECT_GT(force[0], 0.1);
  for (int k : {1, 2}) EXPECT_NEAR(force[k] / force[0], 1.0, 2e-3) << k;
}

// Sides are ordered internally: the order in the scene changes no bit.
TEST(ToolOnObstacle, TheOrderOfNamesChangesNoBit) {
  for (const char* scheme : {"partitioned", "monolithic", "single_rate"}) {
    scene::Description d = squeezed(scheme, "condensed");
    for (ContactSpec& contact : d.contacts) contact.friction = 0.3;
    const auto ticks = run(d);
    for (ContactSpec& contact : d.contacts) std::swap(contact.first, contact.second);
    const auto other = run(d);
    ASSERT_EQ(ticks.size(), other.size());
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      EXPECT_EQ(ticks[i].tool.translation, other[i].tool.translation);
      EXPECT_EQ(ticks[i].contact.force, other[i].contact.force);
      EXPECT_EQ(ticks[i].contact.moment, other[i].contact.moment);
    }
  }
}

TEST(ToolOnObstacle, WhatCannotTouchIsRefused) {
  const auto refusal = [](const char* first, const char* second) {
    scene::Description d = squeezed("partitioned", "frozen");
    d.contacts[0].first = first;
    d.contacts[0].second = second;
    try {
      loop::assemble(d);
    } catch (const Error& e) { return std::string(e.what()); }
    return std::string("accepted");
  };
  for (const auto& [a, b] : {std::pair{"floor", "stop"}, {"tool", "tool"}, {"stop", "nothing"}})
    EXPECT_NE(refusal(a, b).find(
                  "one side must be a soft body, or a tool if the other is an obstacle or another tool"),
              std::string::npos)
        << refusal(a, b);
  EXPECT_NE(refusal("block", "nothing").find("nothing is called \"nothing\""), std::string::npos);
}

// A ball reaches a plate of 1 cm at 10 m/s, 5 cm per tick: it passes through and is counted; or, sub-stepped,
// it bounces or stays on the plate.
TEST(ToolOnObstacle, AThinPlateIsNotMissedWithSubSteps) {
  for (const bool substep : {false, true}) {
    scene::Description d = ball_over("box", 0.09);
    d.gravity_m_s2 = Vec3(0, 0, -1000.0);
    d.obstacles[0].shape = {{"size_m", Vec3(0.2, 0.2, 0.01)}, {"position_m", Vec3(0, 0, -0.005)}};
    d.contacts[0].stiffness_pa_m = 1e10;
    d.tool->tick_s = d.exchange.exchange_period_s;
    d.duration_s = 0.03;
    if (substep) d.exchange.tunnelling = scene::TunnellingPolicy::kSubstep;
    loop::RunResult result;
    const auto ticks = run(d, Vec3::Zero(), &result);
    EXPECT_EQ(result.tunnelled, std::vector<long>{substep ? 0 : 1});
    EXPECT_EQ(result.sub_steps > 0, substep);
    EXPECT_EQ(ticks.back().tool.translation.z() > 0.5 * kR, substep);
    for (const auto& tick : ticks)
      if (substep) { EXPECT_GT(tick.tool.translation.z(), 0.5 * kR) << tick.time; }
  }
}

#endif
