#include <gtest/gtest.h>

#include "loop/small_scenes.h"
#include "loop/summary.h"
#include "palpate/loop/run.h"
#include "summary_rows.h"

/// A free block thrown at a plate thinner than its path between two queries.
namespace {

using namespace palpate;

constexpr double kThickness = 0.008, kPeriod = 0.01;
constexpr long kBlockVertices = 66, kBottomVertices = 25, kPlateVertices = 8;

/// The block flies down at `speed` and reaches the plate, whose upper face is z = 0, after about a tenth of a
/// period. Its wave speed is 30 times its speed, so that it remains a block; the contact spring alone would
/// stop it within speed sqrt(m / (k A)) = 3 mm, m / A = 20 kg/m^2.
scene::Description thrown(double speed) {
  scene::Description d = small_scenes::held_block();
  d.bodies[0].attachments.clear();
  d.bodies[0].youngs_modulus_pa = 1e6 * speed * speed;
  d.bodies[0].stiffness_damping_s = 1e-5 / speed;
  d.bodies[0].position_m = Vec3(0.001, 0.002, 0.01 + 5e-4 + 0.1 * speed * kPeriod);
  d.bodies[0].velocity_m_s = Vec3(0, 0, -speed);
  d.gravity_m_s2 = Vec3::Zero();
  ContactSpec contact;
  contact.first = "block";
  contact.second = "plate";
  contact.method = "distance";
  contact.stiffness_pa_m = 20.0 * speed * speed / (3e-3 * 3e-3);
  d.contacts.push_back(contact);
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = kPeriod;
  d.integrator.step_s = kPeriod;
  d.duration_s = speed < 1.0 ? 0.15 : 0.04;
  return d;
}

/// A soft plate with all nodes held.
scene::Description at_soft_plate(double speed) {
  scene::Description d = thrown(speed);
  SoftBodySpec plate = small_scenes::held_block().bodies[0];
  plate.name = "plate";
  plate.mesh.size_m = Vec3(0.1, 0.1, kThickness);
  plate.mesh.element_size_m = 0.02;
  plate.position_m = Vec3(0, 0, -0.5 * kThickness);
  plate.youngs_modulus_pa = d.bodies[0].youngs_modulus_pa;
  plate.attachments[0].box_min_m.z() = -1.0;
  d.bodies.push_back(plate);
  return d;
}

/// A tool too heavy to move.
[[maybe_unused]] scene::Description at_tool(double speed) {
  scene::Description d = thrown(speed);
  d.contacts[0].second = "tool";
  d.tool.emplace();
  d.tool->shape = ToolShape::kMesh;
  d.tool->mesh.generator = "box";
  d.tool->mesh.size_m = Vec3(0.1, 0.1, kThickness);
  d.tool->mesh.element_size_m = 0.02;
  d.tool->mass_kg = 1000;
  d.tool->inertia_kg_m2 = Vec3(100, 100, 100);
  d.tool->position_m = Vec3(0, 0, -0.5 * kThickness);
  d.device.emplace();
  KeyframeSpec hold;
  hold.position_m = d.tool->position_m;
  d.device->keyframes.push_back(hold);
  return d;
}

struct Ran {
  loop::RunResult result;
  double velocity;  ///< velocity of the block's centre, upwards [m/s]
  double height;    ///< height of the block's centre; the plate's top is at 0 [m]
  store::Summary summary;
};
Ran run(const scene::Description& d, bool real_time = false) {
  const auto world = loop::assemble(d);
  loop::RunOptions options;
  options.real_time = real_time;
  Ran out{loop::run(*world, options), 0.0, 0.0, {}};
  EXPECT_TRUE(out.result.status.ok()) << out.result.status.message;
  const auto& block = *world->state.layout().find(world->bodies[0].block_id);
  const VecX& m = world->bodies[0].masses;
  for (Eigen::Index i = 0; i < m.size(); ++i) {
    out.velocity += m[i] / m.sum() * world->state.u()[block.u_offset + 3 * i + 2];
    out.height += m[i] / m.sum() * world->state.q()[block.q_offset + 3 * i + 2];
  }
  out.summary = loop::summarise(*world, out.result, 0.0);
  return out;
}

using Target = scene::Description (*)(double);
std::vector<Target> targets() {
  std::vector<Target> out = {at_soft_plate};
#ifdef PALPATE_HAS_TOOL
  out.push_back(at_tool);
#endif
  return out;
}

#ifdef PALPATE_HAS_GL
constexpr const char* kMethods[] = {"image", "distance"};
#else
constexpr const char* kMethods[] = {"distance"};
#endif
/// Calls visit(description, speed) for each target, with each method.
template <class Visit>
void for_each_target(const Visit& visit) {
  for (const Target target : targets())
    for (const char* method : kMethods)
      for (const double speed : {0.1, 1.0, 10.0, 100.0}) {
        scene::Description d = target(speed);
        d.contacts[0].method = method;
        SCOPED_TRACE(fmt::format("block - {}, {}, {} m/s", d.contacts[0].second, method, speed));
        visit(d, speed);
      }
}

}  // namespace

// A step of 10 ms begins before the block reaches the plate and ends beyond it, so that no force acts. At 0.1
// m/s it moves 1 mm, into the plate; at 1 m/s its lower face ends 0.5 mm below the plate; from 10 m/s on it
// is through as a whole, having passed over the plate's eight vertices.
TEST(Tunnelling, WhatGoesThroughABodyIsReported) {
  for_each_target([](scene::Description d, double speed) {
    d.duration_s = 0.011;  // until the query after the passage
    Ran ran = run(d);
    const long expected = speed < 1.0 ? 0 : speed < 9.0 ? kBottomVertices : kBlockVertices + kPlateVertices;
    ASSERT_EQ(ran.result.tunnelled.size(), 1u);
    EXPECT_EQ(ran.result.tunnelled[0], expected);
    const store::SummaryFields& row = ran.summary.list("contacts").at(0);
    EXPECT_EQ(summary_rows::count(row, "tunnelled"), expected);
    EXPECT_EQ(summary_rows::count(row, "fast_regions") > 0, speed >= 1.0);
    EXPECT_EQ(ran.result.sub_steps, 0);
  });
}

// With sub-steps the block is detected in the plate at most half of its thickness deep, and bounces: its
// momentum is reversed at any speed, with the minimum of additional queries.
TEST(Tunnelling, SubStepsTurnItRound) {
  for_each_target([](scene::Description d, double speed) {
    d.exchange.tunnelling = scene::TunnellingPolicy::kSubstep;
    d.exchange.shortest_refresh_s = 1e-6;
    Ran ran = run(d);
    EXPECT_EQ(ran.result.tunnelled, std::vector<long>{0});
    EXPECT_GT(ran.velocity, speed < 50.0 ? 0.0 : -1e-5 * speed) << "at 100 m/s the steps take all of it away";
    EXPECT_GT(ran.height, 0.0) << "it is on the side that it came from";
    EXPECT_LE(ran.velocity, 1.001 * speed) << "no energy from nowhere";
    EXPECT_EQ(ran.result.sub_steps > 0, speed >= 1.0);
    EXPECT_LT(ran.result.sub_steps, 40);
    EXPECT_EQ(ran.result.shortest_refreshes, 0);
    EXPECT_EQ(summary_rows::count(ran.summary.section("counts").values, "sub_steps"), ran.result.sub_steps);
  });
}

#ifdef PALPATE_HAS_TOOL
// In real time as well: the ticks are over when the bodies advance through their period, and query contact in
// it as often as needed.
TEST(Tunnelling, SubStepsInRealTime) {
  scene::Description d = at_tool(10.0);
  d.exchange.tunnelling = scene::TunnellingPolicy::kSubstep;
  d.exchange.shortest_refresh_s = 1e-6;
  const Ran ran = run(d, true);
  EXPECT_EQ(ran.result.tunnelled, std::vector<long>{0});
  EXPECT_GT(ran.velocity, 0.0);
  EXPECT_GT(ran.result.sub_steps, 0);
  d.exchange.tunnelling = scene::TunnellingPolicy::kReport;
  d.duration_s = 0.011;
  EXPECT_GT(run(d).result.tunnelled[0], 0) << "what a step without them does";
}
#endif

// The limit is respected: no query within less than 2 ms, so that the block passes through, and both are
// counted.
TEST(Tunnelling, SubStepsStopAtTheirLimit) {
  scene::Description d = at_soft_plate(100.0);
  d.exchange.tunnelling = scene::TunnellingPolicy::kSubstep;
  d.exchange.shortest_refresh_s = 2e-3;
  d.duration_s = 0.011;
  const Ran ran = run(d);
  EXPECT_GT(ran.result.tunnelled[0], 0);
  EXPECT_GT(ran.result.shortest_refreshes, 0);
  EXPECT_LE(ran.result.sub_steps, 6);
}
