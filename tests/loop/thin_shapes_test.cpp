#include <gtest/gtest.h>

#include "loop/penetration.h"
#include "loop/small_scenes.h"
#include "palpate/loop/run.h"

/// Shapes that a body's points miss: thinner than its mesh, smaller than its elements, or inside of it.
namespace {

using namespace palpate;

double mean_height(const loop::World& world) {
  double sum = 0.0;
  const VecX& q = world.state.q();
  const dynamics::Block* block = world.state.layout().find(world.bodies[0].block_id);
  for (int i = 2; i < block->q_size; i += 3) sum += q[block->q_offset + i];
  return 3.0 * sum / block->q_size;
}

/// A soft block of 1 kg falls by 1 mm onto a bar of 10 mm between two rows of its nodes.
scene::Description block_on_bar() {
  scene::Description d;
  d.duration_s = 0.3;
  SoftBodySpec body;
  body.name = "block";
  body.mesh.generator = "box";
  body.mesh.size_m = Vec3::Constant(0.1);
  body.mesh.element_size_m = 0.02;
  body.position_m = Vec3(0, 0, 0.056);
  body.youngs_modulus_pa = 1e5;
  body.stiffness_damping_s = 3e-3;
  d.bodies.push_back(body);
  ObstacleSpec bar{"bar", "cylinder"};
  bar.shape["radius_m"] = 0.005;
  bar.shape["length_m"] = 0.3;
  bar.shape["rotation_vector_rad"] = Vec3(0.5 * std::numbers::pi, 0.0, 0.0);
  d.obstacles.push_back(bar);
  ContactSpec contact;
  contact.first = "block";
  contact.second = "bar";
  contact.stiffness_pa_m = 1e7;
  contact.damping_pa_s_m = 1e4;
  d.contacts.push_back(contact);
  d.integrator.name = "linearly-implicit-euler";
  d.integrator.step_s = 0.002;
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.002;
  return d;
}

TEST(ThinShapes, ABlockComesToLieOnABarThinnerThanItself) {
  scene::Description d = block_on_bar();
  const auto world = loop::assemble(d);
  ASSERT_TRUE(loop::run(*world, {}).status.ok());
  EXPECT_GT(mean_height(*world), 0.04);  // free fall: 0.056 - 0.44
  EXPECT_LT(mean_height(*world), 0.056);
  EXPECT_LT(loop::penetration_reports(*world)[0].deepest_m, 0.005);
}

/// A round tool at `z` with its handle there, or moving to `end`, over a soft ball of 50 mm that rests on its
/// lower cap.
scene::Description tool_and_ball(double radius, double z, double end) {
  scene::Description d;
  SoftBodySpec body;
  body.name = "ball";
  body.mesh.generator = "ball";
  body.mesh.radius_m = 0.05;
  body.mesh.element_size_m = 0.012;
  body.position_m = Vec3(0, 0, 0.05);
  body.youngs_modulus_pa = 1e4;
  body.poissons_ratio = 0.4;
  body.stiffness_damping_s = 2e-3;
  AttachmentSpec cap;
  cap.box_min_m = Vec3(-0.05, -0.05, -0.001);
  cap.box_max_m = Vec3(0.05, 0.05, 0.012);
  body.attachments.push_back(cap);
  d.bodies.push_back(body);
  d.tool.emplace();
  d.tool->radius_m = radius;
  d.tool->mass_kg = 0.05;
  d.tool->position_m = Vec3(0, 0, z);
  d.device.emplace();
  KeyframeSpec key;
  key.position_m = d.tool->position_m;
  d.device->keyframes.push_back(key);
  if (end != z) {
    key.time_s = 0.3;
    key.position_m.z() = end;
    d.device->keyframes.push_back(key);
  }
  ContactSpec contact;
  contact.first = "ball";
  contact.second = "tool";
  contact.stiffness_pa_m = 1e7;
  d.contacts.push_back(contact);
  d.integrator.name = "linearly-implicit-euler";
  d.integrator.step_s = 0.005;
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.005;
  return d;
}

struct LargestForce : loop::Observer {
  double force_n = 0.0;
  void tick(const loop::TickRecord& tick) override { force_n = std::max(force_n, tick.device.force.norm()); }
};

// By the points of the ball's skin alone the force would be 1.0 N, which is k pi 4 R^3/27, their maximum at
// any depth: on a flat skin the distance to a sphere's surface decreases from R/3 on. Hertz with the
// coupling's spring: 2 N; an image of the skin: 2.0 N here, 1.5 N with finer elements.
TEST(ThinShapes, AToolSmallerThanTheElementsIsFelt) {
  scene::Description d = tool_and_ball(0.006, 0.112, 0.085);
  d.duration_s = 0.4;
  const auto world = loop::assemble(d);
  LargestForce largest;
  loop::RunOptions options;
  options.observers = {&largest};
  ASSERT_TRUE(loop::run(*world, options).status.ok());
  EXPECT_GT(largest.force_n, 1.5);
  EXPECT_LT(largest.force_n, 2.1);
}

// The body's skin is farther from the tool than the tool's surface everywhere: the skin's points do not
// detect it.
TEST(ThinShapes, AToolThatBeginsWithinABodyIsPushedOut) {
  scene::Description d = tool_and_ball(0.008, 0.07, 0.07);
  d.duration_s = 0.1;
  const auto world = loop::assemble(d);
  LargestForce largest;
  loop::RunOptions options;
  options.observers = {&largest};
  ASSERT_TRUE(loop::run(*world, options).status.ok());
  EXPECT_GT(largest.force_n, 1.0);
  EXPECT_GT(loop::penetration_reports(*world)[0].deepest_m, 0.03);
}

}  // namespace
