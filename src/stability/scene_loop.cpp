#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include "palpate/core/error.h"
#include "palpate/device/profile.h"
#include "palpate/loop/world.h"
#include "palpate/stability/z_width.h"

// What a contact is worth at the tool.  Of a patch of radius a, with k the pressure per depth [Pa/m]:
//     penalty    k pi a^2            the springs side by side
//     body       2 E a/(1 - nu^2)    a flat punch on an elastic half-space (Sneddon 1965)
// in series where the other side is a soft body.  The patch lies between a tenth of the tool's radius and all
// of it; the radius of a mesh is half of its largest extent.  Where E has regions, the stiffest counts for
// the greatest value.  Damping: d pi a^2.  What yields by its mass (a free body) is taken as held: stiffer.

namespace palpate::stability {
namespace {

double radius_of(const scene::Description& d) {
  if (d.tool->shape != "mesh") return d.tool->radius_m;
  const auto folder = std::filesystem::path(d.path).parent_path();
  const TriMesh surface = loop::tool_surface(*d.tool, folder.string());
  const Vec3 size = surface.vertices.rowwise().maxCoeff() - surface.vertices.rowwise().minCoeff();
  return 0.5 * size.maxCoeff();
}

/// Plane-strain modulus of what the tool touches there; infinite for what is rigid.
double modulus_of(const scene::Description& d, const std::string& other) {
  for (const SoftBodySpec& body : d.bodies)
    if (body.name == other) return body.youngs_modulus_pa / (1.0 - body.poissons_ratio * body.poissons_ratio);
  return std::numeric_limits<double>::infinity();
}

ToolContact patch(const ContactSpec& contact, double modulus, double a) {
  const double area = std::numbers::pi * a * a, penalty = contact.stiffness_pa_m * area;
  return {1.0 / (1.0 / penalty + 1.0 / (2.0 * modulus * a)), contact.damping_pa_s_m * area};
}

/// A simulated hand is what its keys say, the arm that holds it included.  Of another device the scene knows
/// the profile's mass at most.
void add_device(const DeviceSpec& spec, HapticLoop& loop) {
  const device::DeviceFigures figures = device::figures_of(spec);
  loop.device.mass_kg = figures.mass;
  if (spec.type != "hand") return;
  loop.device.damping_n_s_m = figures.damping;
  loop.device.arm_mass_kg = spec.arm_mass_kg;
  loop.device.arm_damping_n_s_m = spec.arm_damping_n_s_m;
  loop.device.arm_stiffness_n_m = spec.arm_stiffness_n_m;
  loop.delay_ticks = static_cast<int>(std::ceil(spec.delay_s / loop.tick_s - 1e-9));
}

}  // namespace

HapticLoop loop_of(const scene::Description& d) {
  if (!d.tool)
    fail("{}: haptic stability: the scene has no [tool], so nothing that a hand would feel", d.name);
  if (d.exchange.scheme == "monolithic")
    fail(
        "{}: haptic stability: exchange.scheme = \"monolithic\" has no ticks of its own; take "
        "--set exchange.scheme=partitioned",
        d.name);
  HapticLoop loop;
  loop.tick_s = d.tool->tick_s;
  loop.coupling_stiffness_n_m = d.tool->coupling.stiffness_n_m;
  loop.coupling_damping_n_s_m = d.tool->coupling.damping_n_s_m;
  loop.tool_mass_kg = d.tool->mass_kg;
  loop.tool_integrator = d.tool->integrator;
  if (d.device) add_device(*d.device, loop);
  return loop;
}

ToolContactRange contact_range(const scene::Description& d) {
  const double radius = radius_of(d);
  ToolContactRange out;
  out.least.stiffness = std::numeric_limits<double>::infinity();
  for (const ContactSpec& contact : d.contacts) {
    if (contact.first != "tool" && contact.second != "tool") continue;
    if (contact.spring == "per_point")
      fail(
          "{}: haptic stability: contact \"{}\" - \"{}\" has springs at points, whose number decides how "
          "stiff it is; say --contact-stiffness-n-m LEAST GREATEST",
          d.name, contact.first, contact.second);
    const double modulus = modulus_of(d, contact.first == "tool" ? contact.second : contact.first);
    const ToolContact least = patch(contact, modulus, 0.1 * radius), most = patch(contact, modulus, radius);
    if (least.stiffness < out.least.stiffness) out.least = least;
    if (most.stiffness > out.greatest.stiffness) out.greatest = most;
  }
  if (out.greatest.stiffness <= 0.0)
    fail("{}: haptic stability: no [[contact]] names the tool; say --contact-stiffness-n-m LEAST GREATEST",
         d.name);
  return out;
}

}  // namespace palpate::stability
