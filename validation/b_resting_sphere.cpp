#include <cmath>

#include "b_free_tool.h"
#include "cases.h"
#include "palpate/core/error.h"

// Problem: a rigid sphere with mass m on a flat skin, at rest and in a small bounce.
//
// Exact answer, with the contact force k V(delta) (SphereOnSkin):
//     m g = k V(delta0)                              gives the depth at rest,
//     w^2 = k V'(delta0)/m                           the frequency of a small bounce about it.
//
// Measured: force and depth at rest, frequency; limit 1e-3. With the amplitude A the frequency changes by
// about (1/24) (A/delta0)^2 relative: 2e-5 at A = 0.02 delta0. The frequency is computed from positions x_i,
// T apart: x_{i+1} + x_{i-1} = 2 cos(w T) x_i + constant holds for any phase, amplitude and mean, so a line
// fitted to the pairs yields it. Facets lie inside the sphere, by h^2/(12 R) on average, and the depth at
// rest changes by this; in the frequency it cancels to first order, as the wetted area belongs to the force.

namespace palpate::validation {
namespace {

constexpr double kRadius = 0.01, kDepth = 2e-3, kMass = 0.1, kGravity = 9.81;
constexpr SphereOnSkin kSphere{kRadius};
const double kStiffness = kMass * kGravity / kSphere.force(kDepth);
const double kWetted = kSphere.stiffness(kDepth);
const double kOmega = std::sqrt(kStiffness * kWetted / kMass);

/// Returns a spoiler: half of the contact force is removed, or the tool's inertia grows by a hundredth while
/// its weight does not.
Spoiler spoiler(const std::string& fault) {
  return [fault](loop::World& world) {
    if (fault == "half-force") add_to(world, scaled(world.contact, {.force = -0.5}));
    if (fault == "more-inertia") add_to(world, scaled(world.system.inertias().back(), 0.01));
  };
}

scene::Description on_plane() {
  scene::Description d = free_tool_scene(0.02, 0.02, 0.005);
  d.gravity_m_s2 = Vec3(0, 0, -kGravity);
  d.contacts[0].stiffness_pa_m = kStiffness;
  d.contacts[0].candidate_gap_m = 2e-4;
  d.tool->mesh.generator = "ball";
  d.tool->mesh.radius_m = kRadius;
  d.tool->mesh.element_size_m = 2e-4;
  d.tool->mass_kg = kMass;
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 4e-3;
  d.integrator.step_s = 5e-4;
  d.contacts[0].quadrature_error = 3e-3;
  return d;
}

/// Returns the angular frequency [rad/s] from x_{i+1} + x_{i-1} = 2 cos(w T) x_i + constant, T apart.
double angular_frequency(const std::vector<loop::TickRecord>& ticks, int stride) {
  const double mean = [&] {
    double sum = 0.0;
    for (const auto& tick : ticks) sum += tick.tool.translation.z();
    return sum / static_cast<double>(ticks.size());
  }();
  const auto x = [&](std::size_t i) { return ticks[i].tool.translation.z() - mean; };
  const auto T = static_cast<std::size_t>(stride);
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t i = T; i + T < ticks.size(); ++i) {
    const double y = x(i + T) + x(i - T);
    n += 1.0;
    sx += x(i);
    sy += y;
    sxx += x(i) * x(i);
    sxy += x(i) * y;
  }
  const double cosine = 0.5 * (n * sxy - sx * sy) / (n * sxx - sx * sx);
  return std::acos(cosine) / (static_cast<double>(stride) * (ticks[1].time - ticks[0].time));
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  {
    scene::Description rest = on_plane();
    rest.duration_s = 0.12;
    rest.contacts[0].damping_pa_s_m = 2.0 * std::sqrt(kStiffness * kWetted * kMass) / kWetted;  // Critical.
    rest.tool->position_m = Vec3(2e-4, 1e-4, kRadius - 0.9 * kDepth);
    const loop::TickRecord last = run_free_tool(rest, spoiler(fault)).back();
    const double force = last.contact.force.z(), weight = kMass * kGravity;
    out.push_back({.quantity = "contact force at rest [N]",
                   .computed = force,
                   .exact = weight,
                   .error = std::abs(force / weight - 1.0),
                   .bar = 1e-3});
    const double depth = kRadius - last.tool.translation.z();
    out.push_back({.quantity = "depth at rest [m]",
                   .computed = depth,
                   .exact = kDepth,
                   .error = std::abs(depth / kDepth - 1.0),
                   .bar = 1e-3,
                   .note = "facets of 0.2 mm lie inside the sphere; the plane's points are 0.45 mm apart"});
    scene::Description bounce = on_plane();
    bounce.duration_s = 0.16;
    bounce.tool->position_m = Vec3(2e-4, 1e-4, kRadius - 1.02 * kDepth);
    const double omega = angular_frequency(run_free_tool(bounce, spoiler(fault)), 10);
    out.push_back({.quantity = "angular frequency of a bounce of 0.02 delta0 [rad/s]",
                   .computed = omega,
                   .exact = kOmega,
                   .error = std::abs(omega / kOmega - 1.0),
                   .bar = 1e-3});
  }
  return out;
}

}  // namespace

ValidationCase resting_sphere() {
  return {.name = "resting-sphere",
          .section = "B",
          .summary =
              "a rigid sphere on a flat skin under gravity: force and depth at rest, frequency of a small "
              "bounce",
          .why =
              "force and stiffness of one contact, through points, law and integrator: wrong areas show in "
              "the depth, a wrong tangent or too few candidates in the frequency (closed form of the law)",
          .quick = true,
          .run = run,
          .faults = {{"half-force", "at rest"}, {"more-inertia", "angular frequency"}}};
}

}  // namespace palpate::validation
