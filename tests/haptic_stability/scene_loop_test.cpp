// Largest stiffness that contacts of a scene give to the haptic loop.
#include <gtest/gtest.h>

#include <cmath>

#include "haptic_stability/tool_section.h"
#include "haptic_stability/z_width.h"
#include "palpate/core/error.h"
#include "palpate/device/profile.h"
#include "palpate/loop/run.h"
#include "palpate/mesh/source.h"

using namespace palpate;
using namespace palpate::haptic_stability;

namespace {

scene::Description on_a_wall(const MeshSpec& mesh) {
  scene::Description d;
  d.name = "on a wall";
  d.tool.emplace();
  d.tool->shape = ToolShape::kMesh;
  d.tool->mesh = mesh;
  d.tool->inertia_kg_m2 = Vec3::Constant(1e-5);
  d.obstacles.resize(1);
  d.obstacles[0].name = "wall";
  d.obstacles[0].type = "plane";
  d.contacts.resize(1);
  d.contacts[0] = {.first = "tool", .second = "wall", .stiffness_pa_m = 1e6};
  return d;
}

MeshSpec box(const Vec3& size) {
  MeshSpec out;
  out.generator = "box";
  out.size_m = size;
  out.element_size_m = size.minCoeff();
  return out;
}

struct LastTick : loop::Observer {
  void tick(const loop::TickRecord& one) override { last = one; }
  loop::TickRecord last;
};

double stiffest(const scene::Description& d) { return contact_range(d).greatest.stiffness; }

}  // namespace

// A flat tool rests on its largest side: k times its area, not the area of a disc around it.
TEST(ZWidth, lays_flat_tools_on_their_largest_side) {
  EXPECT_NEAR(stiffest(on_a_wall(box(Vec3(0.02, 0.02, 0.02)))), 400.0, 1e-9);
  EXPECT_NEAR(stiffest(on_a_wall(box(Vec3(0.01, 0.02, 0.04)))), 800.0, 1e-9);
  EXPECT_NEAR(stiffest(on_a_wall(box(Vec3(0.05, 0.004, 0.004)))), 200.0, 1e-9);
  TriMesh turned = mesh::surface(box(Vec3(0.02, 0.02, 0.02)), "");
  turned.vertices = quaternion_of(Vec3(0.3, -0.5, 0.2)).toRotationMatrix() * turned.vertices;
  EXPECT_NEAR(largest_section(turned), 4e-4, 1e-12);
}

// The box of 10 x 20 x 40 mm, cut across each side, and across a corner: the triangle at the distance d from
// it has the area 3 sqrt(3)/2 d^2.
TEST(ToolSection, is_that_of_a_box) {
  const TriMesh surface = mesh::surface(box(Vec3(0.01, 0.02, 0.04)), "");
  const Vec3 low = surface.vertices.rowwise().minCoeff();
  EXPECT_NEAR(section_area(surface, Vec3::UnitX(), low.x() + 0.004), 8e-4, 1e-15);
  EXPECT_NEAR(section_area(surface, Vec3::UnitY(), low.y() + 0.004), 4e-4, 1e-15);
  EXPECT_NEAR(section_area(surface, -Vec3::UnitZ(), -low.z() - 0.004), 2e-4, 1e-15);
  const Vec3 n = Vec3::Ones().normalized();
  for (const double d : {0.001, 0.003, 0.005})
    EXPECT_NEAR(section_area(surface, n, n.dot(low) + d), 1.5 * std::sqrt(3.0) * d * d, 1e-15) << d;
  EXPECT_EQ(section_area(surface, n, n.dot(low) - 0.001), 0.0);
}

// A triangulated ball is cut at nearly its largest circle: the polyhedron is inside it.
TEST(ZWidth, cuts_round_meshes_at_their_widest) {
  MeshSpec ball;
  ball.generator = "ball";
  ball.radius_m = 0.01;
  ball.element_size_m = 1.25e-3;
  const double circle = 1e6 * M_PI * 1e-4, found = stiffest(on_a_wall(ball));
  EXPECT_LE(found, circle);
  EXPECT_NEAR(found / circle, 1.0, 0.02);
}

// For a soft body the flat punch of the same area is in series; among two contacts the stiffest counts.
TEST(ZWidth, puts_flat_tools_in_series_with_soft_bodies) {
  scene::Description d = on_a_wall(box(Vec3(0.02, 0.02, 0.02)));
  d.bodies.resize(1);
  d.bodies[0].name = "soft";
  d.bodies[0].youngs_modulus_pa = 1e4;
  d.bodies[0].poissons_ratio = 0.5;
  d.contacts[0].second = "soft";
  const double body = 2.0 * 1e4 / 0.75 * std::sqrt(4e-4 / M_PI);
  EXPECT_NEAR(stiffest(d), 1.0 / (1.0 / 400.0 + 1.0 / body), 1e-9);
  d.contacts.push_back({.first = "wall", .second = "tool", .stiffness_pa_m = 1e6});
  EXPECT_NEAR(stiffest(d), 400.0, 1e-9);
}

#ifdef PALPATE_HAS_TOOL
// Stiffness in a run: the slope of the force on a box pressed flat on a wall, without the contribution of its
// sides, with the perimeter 4 a for a face of a^2: 4/a times the mean depth.
TEST(ZWidth, has_the_stiffness_of_a_run) {
  scene::Description d = on_a_wall(box(Vec3(0.02, 0.02, 0.02)));
  d.duration_s = 0.3;
  d.tool->position_m = Vec3(0, 0, 0.0101);
  d.tool->mass_kg = 0.005;
  d.tool->coupling.damping_n_s_m = 5.0;
  d.device.emplace();
  double depth[2], force[2];
  for (const int i : {0, 1}) {
    d.device->keyframes.clear();
    d.device->keyframes.push_back({0.0, d.tool->position_m, Vec3::Zero(), Interpolation::kMinimumJerk});
    d.device->keyframes.push_back(
        {0.1, Vec3(0, 0, 0.009 - 0.001 * i), Vec3::Zero(), Interpolation::kMinimumJerk});
    LastTick last;
    const auto world = loop::assemble(d);
    loop::RunOptions options;
    options.observers = {&last};
    ASSERT_TRUE(loop::run(*world, options).status.ok());
    depth[i] = 0.01 - last.last.tool.translation.z();
    force[i] = last.last.contact.force.z();
  }
  EXPECT_GT(depth[1], depth[0]);
  EXPECT_NEAR((force[1] - force[0]) / (depth[1] - depth[0]) / stiffest(d),
              1.0 + 4.0 / 0.02 * 0.5 * (depth[0] + depth[1]), 1e-3);
}
#endif

// The verdicts refer to the scene's device.
TEST(ZWidth, takes_the_scene_s_device) {
  scene::Description d;
  d.tool.emplace();
  d.tool->tick_s = 1e-3;
  const OneAxisLoop usual = loop_of(d);
  EXPECT_EQ(usual.device.arm_stiffness_n_m, 0.0);
  d.device.emplace();
  d.device->profile = "premium-1.5";
  EXPECT_EQ(loop_of(d).device.mass_kg, device::figures_of(*d.device).mass);
  EXPECT_NE(loop_of(d).device.mass_kg, usual.device.mass_kg);
  EXPECT_EQ(loop_of(d).device.damping_n_s_m, usual.device.damping_n_s_m);
  d.device->type = "hand";
  d.device->device_mass_kg = 0.2;
  d.device->device_damping_n_s_m = 0.7;
  d.device->arm_mass_kg = 0.5;
  d.device->arm_damping_n_s_m = 4.0;
  d.device->arm_stiffness_n_m = 300.0;
  d.device->delay_s = 0.0021;
  const OneAxisLoop loop = loop_of(d);
  EXPECT_EQ(loop.device.mass_kg, 0.2);
  EXPECT_EQ(loop.device.damping_n_s_m, 0.7);
  EXPECT_EQ(loop.device.total_mass(), 0.7);
  EXPECT_EQ(loop.device.total_damping(), 4.7);
  EXPECT_EQ(loop.device.arm_stiffness_n_m, 300.0);
  EXPECT_EQ(loop.delay_ticks, 3);
  d.device->delay_s = 0.002;
  EXPECT_EQ(loop_of(d).delay_ticks, 2);
}
