#include <cmath>

#include "b_free_tool.h"
#include "cases.h"
#include "image_backends.h"
#include "palpate/core/error.h"

// A rigid sphere of mass m lies on a plane.  With V(delta) = pi delta^2 (3 R - delta)/3,
//     m g = k V(delta0)                              gives the depth at rest,
//     w^2 = k V'(delta0)/m = k pi (2 R delta0 - delta0^2)/m    the frequency of a small bounce about it.
// For an amplitude A the frequency changes by about (1/24) (A/delta0)^2 of it: 2e-5 at A = 0.02 delta0.
//
// The frequency is read from positions x_i, T apart: x_{i+1} + x_{i-1} = 2 cos(w T) x_i + constant holds for
// any phase, amplitude and mean, so a line fitted to the pairs gives it.
//
// The facets lie inside the sphere, by h^2/(12 R) in the mean: that is what the depth at rest differs by; in
// the frequency it cancels to first order, as the wetted area belongs to the volume.

namespace palpate::validation {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadius = 0.01, kDepth = 2e-3, kMass = 0.1, kGravity = 9.81;
const double kStiffness = kMass * kGravity / (kPi * kDepth * kDepth * (3.0 * kRadius - kDepth) / 3.0);
const double kWetted = kPi * (2.0 * kRadius * kDepth - kDepth * kDepth);
const double kOmega = std::sqrt(kStiffness * kWetted / kMass);

/// Half of the contact's force, or a tool heavier than its weight by a hundredth.
Spoiler spoiler(const std::string& fault) {
  return [fault](loop::World& world) {
    if (fault == "half-force") add_to(world, scaled(world.contact, {.force = -0.5}));
    if (fault == "more-inertia") add_to(world, scaled(world.system.inertias().back(), 0.01));
  };
}

scene::Description on_plane(contact::DepthBackend backend) {
  scene::Description d = free_tool_scene(backend, 0.04, 0.04);
  d.gravity_m_s2 = Vec3(0, 0, -kGravity);
  d.contacts[0].stiffness_pa_m = kStiffness;
  d.contacts[0].candidate_gap_m = 2e-4;
  d.tool->mesh.generator = "ball";
  d.tool->mesh.radius_m = kRadius;
  d.tool->mesh.element_size_m = 2e-4;
  d.tool->mass_kg = kMass;
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 4e-3;
  d.integrator.step_s = 5e-4;
  d.contacts[0].pixels = 96;
  return d;
}

/// From x_{i+1} + x_{i-1} = 2 cos(w T) x_i + constant, T apart.
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
  for (const contact::DepthBackend backend : image_backends(fault)) {
    const std::string name(contact::backend_name(backend));
    scene::Description rest = on_plane(backend);
    rest.duration_s = 0.12;
    rest.contacts[0].damping_pa_s_m = 2.0 * std::sqrt(kStiffness * kWetted * kMass) / kWetted;  // critical
    rest.tool->position_m = Vec3(2e-4, 1e-4, kRadius - 0.9 * kDepth);
    const loop::TickRecord last = run_free_tool(rest, spoiler(fault)).back();
    const double force = last.contact.force.z(), weight = kMass * kGravity;
    out.push_back({.quantity = name + ": contact force at rest [N]",
                   .computed = force,
                   .exact = weight,
                   .error = std::abs(force / weight - 1.0),
                   .bar = 1e-3});
    const double depth = kRadius - last.tool.translation.z();
    out.push_back({.quantity = name + ": depth at rest [m]",
                   .computed = depth,
                   .exact = kDepth,
                   .error = std::abs(depth / kDepth - 1.0),
                   .bar = 1e-3,
                   .note = "facets of 0.2 mm lie inside the sphere by 4e-4 of the depth"});
    scene::Description bounce = on_plane(backend);
    bounce.duration_s = 0.16;
    bounce.tool->position_m = Vec3(2e-4, 1e-4, kRadius - 1.02 * kDepth);
    const double omega = angular_frequency(run_free_tool(bounce, spoiler(fault)), 10);
    out.push_back({.quantity = name + ": angular frequency of a bounce of 0.02 delta0 [rad/s]",
                   .computed = omega,
                   .exact = kOmega,
                   .error = std::abs(omega / kOmega - 1.0),
                   .bar = 1e-3});
  }
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase resting_sphere() {
  return {.name = "resting-sphere",
          .section = "B",
          .summary =
              "a rigid sphere on a plane under gravity: force and depth at rest, frequency of a small "
              "bounce",
          .why =
              "force and stiffness of one contact, through image, law and integrator: wrong areas show in "
              "the depth, a wrong tangent or too few candidates in the frequency (volume law)",
          .quick = true,
          .run = run,
          .faults = {{"half-force", "at rest"}, {"more-inertia", "angular frequency"}}};
}

}  // namespace palpate::validation
