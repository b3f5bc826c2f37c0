#include <cmath>

#include "b_free_tool.h"
#include "cases.h"
#include "palpate/core/error.h"

// Problem: bodies on a plane inclined by the angle a, in the axes of the plane: gravity is g (sin a, 0, -cos
// a). Coulomb friction mu, regularised below the speed v_r: mu p v/max(|v|, v_r).
//
// Exact answer, a block that does not rotate (balance along the plane).
// - tan a < mu: friction mu N v/v_r balances the component of the weight along the plane,
//       m g sin a = mu m g cos a v/v_r:      the block creeps at v = v_r tan(a)/mu.
// - tan a > mu: it slides with  a_x = g (sin a - mu cos a). Creep and acceleration are measured, limit
//   1e-3. The block is on a rigid obstacle: a soft block would be dented and ploughed by its walls. Only the
//   rotational spring of the coupling, which fixes the orientation, couples it to the handle.
//
// Exact answer, a sphere (linear and angular momentum): friction f rotates it, I w' = f R, m v' = m g sin a -
// f. It rolls, v = w R up to the creep, and with I = 2/5 m R^2:
//     f = (2/7) m g sin a,   v' = (5/7) g sin a;  possible while f < mu N, tan a < 3.5 mu.
// The acceleration is measured. The limit 1e-2 is due to the dent, delta0 <= 0.01 R deep: the effective
// rolling radius is between R - delta0 and R.

namespace palpate::validation {
namespace {

constexpr double kGravity = 9.81, kPi = 3.14159265358979323846;

/// Returns a spoiler that adds a defect to the library's friction.
Spoiler friction_of(const std::string& fault) {
  return [fault](loop::World& world) {
    if (fault == "half-friction") add_to(world, friction_defect(world.contact, 0.5));
    if (fault == "no-friction") add_to(world, friction_defect(world.contact, 0.0));
    if (fault == "friction-without-cap") add_to(world, friction_defect(world.contact, 1.0, true));
  };
}

scene::Description inclined(double angle, double friction) {
  scene::Description d = free_tool_scene(0.16, 0.04, 0.02);
  d.gravity_m_s2 = kGravity * Vec3(std::sin(angle), 0.0, -std::cos(angle));
  d.contacts[0].friction = friction;
  d.contacts[0].friction_regularisation_m_s = 1e-3;
  d.contacts[0].friction_anchors = false;  // The regularised law, to which the faults apply.
  d.tool->position_m.x() = -0.06;
  return d;
}

scene::Description block_on(double angle, double friction) {
  constexpr double kMass = 0.05, kDepth = 2e-4;
  const Vec3 size(0.012, 0.012, 0.004);
  scene::Description d = inclined(angle, friction);
  ObstacleSpec plane;
  plane.name = d.contacts[0].first = "plane";
  plane.type = "plane";
  d.obstacles = {plane};
  d.tool->mesh.generator = "box";
  d.tool->mesh.size_m = size;
  d.tool->mesh.element_size_m = 0.004;
  d.tool->mass_kg = kMass;
  d.tool->inertia_kg_m2 = Vec3::Constant(kMass * (size.x() * size.x() + size.y() * size.y()) / 12.0);
  d.tool->coupling.rotational_stiffness_n_m_rad = 100.0;
  d.tool->coupling.rotational_damping_n_m_s_rad = 0.01;
  const double area = size.x() * size.y(), normal = kMass * kGravity * std::cos(angle);
  d.contacts[0].stiffness_pa_m = normal / (area * kDepth);
  d.contacts[0].damping_pa_s_m = 2.0 * std::sqrt(normal / kDepth * kMass) / area;  // Critical damping.
  d.contacts[0].candidate_gap_m = 1e-4;
  d.integrator.step_s = 5e-4;
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 2e-3;
  d.tool->position_m.z() = 0.5 * size.z() - kDepth;
  return d;
}

std::vector<Measurement> run_block(const std::string& fault) {
  std::vector<Measurement> out;
  constexpr double kFriction = 0.4, kFlat = 15.0 * kPi / 180.0, kSteep = 35.0 * kPi / 180.0;
  {
    scene::Description sticks = block_on(kFlat, kFriction);
    sticks.duration_s = 0.03;
    const double creep = run_free_tool(sticks, friction_of(fault)).back().tool_twist.linear.x(),
                 exact_creep = sticks.contacts[0].friction_regularisation_m_s * std::tan(kFlat) / kFriction;
    out.push_back({.quantity = "creep of a block that sticks, 15 degrees, mu = 0.4 [m/s]",
                   .computed = creep,
                   .exact = exact_creep,
                   .error = std::abs(creep / exact_creep - 1.0),
                   .bar = 1e-3});
    scene::Description slides = block_on(kSteep, kFriction);
    slides.duration_s = 0.1;
    const double a = mean_acceleration(run_free_tool(slides, friction_of(fault)), 0.02, 0.1),
                 exact = kGravity * (std::sin(kSteep) - kFriction * std::cos(kSteep));
    out.push_back({.quantity = "acceleration of a block that slides, 35 degrees, mu = 0.4 [m/s^2]",
                   .computed = a,
                   .exact = exact,
                   .error = std::abs(a / exact - 1.0),
                   .bar = 1e-3});
  }
  return out;
}

std::vector<Measurement> run_sphere(const std::string& fault) {
  constexpr double kRadius = 0.01, kMass = 0.03, kDepth = 0.01 * kRadius, kAngle = 20.0 * kPi / 180.0,
                   kFriction = 0.3;  // 3.5 mu = 1.05, tan a = 0.36
  const double exact = 5.0 / 7.0 * kGravity * std::sin(kAngle);
  std::vector<Measurement> out;
  {
    scene::Description d = inclined(kAngle, kFriction);
    d.tool->mesh.generator = "ball";
    d.tool->mesh.radius_m = kRadius;
    d.tool->mesh.element_size_m = 2.5e-4;
    d.tool->mass_kg = kMass;
    d.contacts[0].stiffness_pa_m = kMass * kGravity * std::cos(kAngle) / SphereOnSkin{kRadius}.force(kDepth);
    d.contacts[0].candidate_gap_m = 5e-5;
    d.integrator.step_s = 2.5e-4;
    d.tool->position_m.z() = kRadius - kDepth;
    d.duration_s = 0.12;
    const std::vector<loop::TickRecord> ticks = run_free_tool(d, friction_of(fault));
    const double a = mean_acceleration(ticks, 0.02, d.duration_s);
    const Twist& end = ticks.back().tool_twist;
    out.push_back({.quantity = "acceleration of a sphere that rolls, 20 degrees, mu = 0.3 [m/s^2]",
                   .computed = a,
                   .exact = exact,
                   .error = std::abs(a / exact - 1.0),
                   .bar = 1e-2,
                   .note = fmt::format("at the end {:.4f} m/s, {:.4f} m/s by its rotation", end.linear.x(),
                                       kRadius * end.angular.y())});
  }
  return out;
}

}  // namespace

ValidationCase block_on_incline() {
  return {.name = "block-on-incline",
          .section = "B",
          .summary =
              "a block on an inclined plane with friction: creep where it sticks, acceleration where it "
              "slides",
          .why =
              "an error of a few per cent in the friction lets objects slide that should stick; the creep of "
              "the regularisation is known (balance along the plane)",
          .quick = true,
          .run = run_block,
          .faults = {{"half-friction", "creep"}, {"friction-without-cap", "acceleration of a block"}}};
}

ValidationCase rolling_sphere() {
  return {.name = "rolling-sphere",
          .section = "B",
          .summary = "a sphere rolls down an inclined plane without slipping: (5/7) g sin a",
          .why =
              "friction must also exert its moment about the centre: without it the sphere slides with g sin "
              "a (linear and angular momentum of a rolling sphere)",
          .quick = true,
          .run = run_sphere,
          .faults = {{"no-friction", "acceleration of a sphere"}}};
}

}  // namespace palpate::validation
