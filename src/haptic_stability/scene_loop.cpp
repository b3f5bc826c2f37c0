#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include "haptic_stability/z_width.h"
#include "palpate/core/error.h"
#include "palpate/device/profile.h"
#include "palpate/loop/world.h"
#include "palpate/tool/tool.h"
#include "tool_section.h"

// Stiffness of a contact at the tool. A foundation of pressure k per depth [Pa/m] gives the force k V for an
// overlap volume V, so that the stiffness is k dV/dz = k A, where A is the cut of the tool with the plane of
// the wall:
//     penalty    k A                 springs in parallel
//     body       2 E a/(1 - nu^2)    a flat punch of radius a on an elastic half-space (Sneddon 1965)
// The two are in series if the other side is a soft body, with pi a^2 = A: a square punch is 1.2 % stiffer
// than the disc of its area. Greatest stiffness: the tool lies on its largest side, or is pressed in up to
// its largest cut; A is pi R^2 for a sphere, the largest section parallel to a face for a mesh. Least
// stiffness: the tool touches with a disc of a tenth of its radius; the radius of a mesh is half its largest
// extent. If E has regions, the stiffest one determines the greatest value. Damping: d A. A free body, which
// yields by its mass, is taken as held, which is stiffer.

namespace palpate::haptic_stability {
namespace {

/// Dimensions of the tool that determine its contacts.
struct Shape {
  double radius;        ///< Half of its largest extent [m]
  double reach;         ///< Distance of its farthest point from its origin [m]
  double largest_area;  ///< Largest contact area with a wall [m^2]
};

double disc(double radius) { return std::numbers::pi * radius * radius; }

Shape shape_of(const scene::Description& d) {
  const double r = d.tool->radius_m;
  if (d.tool->shape != ToolShape::kMesh) return {r, r, disc(r)};
  const auto folder = std::filesystem::path(d.path).parent_path();
  const TriMesh surface = loop::tool_surface(*d.tool, folder.string());
  const Vec3 size = surface.vertices.rowwise().maxCoeff() - surface.vertices.rowwise().minCoeff();
  return {0.5 * size.maxCoeff(), surface.vertices.colwise().norm().maxCoeff(), largest_section(surface)};
}

/// Returns the plane-strain modulus of the body that the tool touches; infinite for a rigid one.
double modulus_of(const scene::Description& d, const std::string& other) {
  for (const SoftBodySpec& body : d.bodies)
    if (body.name == other) return body.youngs_modulus_pa / (1.0 - body.poissons_ratio * body.poissons_ratio);
  return std::numeric_limits<double>::infinity();
}

ToolContact patch(const ContactSpec& contact, double modulus, double area) {
  const double a = std::sqrt(area / std::numbers::pi), penalty = contact.stiffness_pa_m * area;
  return {1.0 / (1.0 / penalty + 1.0 / (2.0 * modulus * a)), contact.damping_pa_s_m * area};
}

/// Copies the device figures to the loop. The scene specifies all figures of a simulated hand, including the
/// arm that holds it; for another device it specifies at most the mass, by the profile.
void add_device(const DeviceSpec& spec, OneAxisLoop& loop) {
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

OneAxisLoop loop_of(const scene::Description& d) {
  if (!d.tool)
    fail("{}: haptic stability: the scene has no [tool], so nothing that a hand would feel", d.name);
  if (d.exchange.scheme == scene::ExchangeScheme::kMonolithic)
    fail(
        "{}: haptic stability: exchange.scheme = \"monolithic\" has no ticks of its own; take "
        "--set exchange.scheme=partitioned",
        d.name);
  OneAxisLoop loop;
  loop.tick_s = d.tool->tick_s;
  loop.coupling_stiffness_n_m = d.tool->coupling.stiffness_n_m;
  loop.coupling_damping_n_s_m = d.tool->coupling.damping_n_s_m;
  loop.tool_mass_kg = d.tool->mass_kg;
  // With a single rate, the integrator of tool and bodies steps once per tick.
  loop.tool_integrator =
      d.exchange.scheme == scene::ExchangeScheme::kSingleRate ? d.integrator.name : d.tool->integrator;
  if (d.device) add_device(*d.device, loop);
  return loop;
}

// A contact force turns the tool by its lever. Least stiffness: a patch of radius a lies under the centre of
// the tool, and its springs resist a tilt: integral of k x^2 over the disc = K a^2/4. Greatest stiffness: the
// contact lies at the farthest point of the tool, at R from its origin: K R^2.
RotationalLoop rotational_loop_of(const scene::Description& d, const OneAxisLoop& loop,
                                  const ToolContactRange& range) {
  constexpr double kStylus = 0.05;  // lever of a device mass about its handle [m]
  constexpr double kHeld = 1e6;     // mass of a held device over the mass of the tool
  const Mat3 inertia = tool::Tool(*d.tool, Vec3::Zero()).mass_matrix().topLeftCorner<3, 3>();
  RotationalLoop out{.loop = loop, .range = range};
  out.inertia_kg_m2 = Eigen::SelfAdjointEigenSolver<Mat3>(inertia).eigenvalues().minCoeff();
  const double a2 = out.inertia_kg_m2 / loop.tool_mass_kg;
  const Shape shape = shape_of(d);
  out.lever_m = std::sqrt(a2);
  out.loop.coupling_stiffness_n_m = d.tool->coupling.rotational_stiffness_n_m_rad / a2;
  out.loop.coupling_damping_n_s_m = d.tool->coupling.rotational_damping_n_m_s_rad / a2;
  OneAxisLoop::Axis& device = out.loop.device;
  if (d.device && d.device->type == "hand") {
    device = {};
    device.mass_kg = d.device->rotational_inertia_kg_m2 / a2;
    device.damping_n_s_m = 0.0;
    device.arm_damping_n_s_m = d.device->arm_rotational_damping_n_m_s_rad / a2;
    device.arm_stiffness_n_m = d.device->arm_rotational_stiffness_n_m_rad / a2;
  } else {
    device.mass_kg *= kStylus * kStylus / a2;
    device.damping_n_s_m *= kStylus * kStylus / a2;
  }
  out.driven = !d.device || device::figures_of(*d.device).max_torque > 0.0;
  if (!out.driven) {  // a device without torque output is held: its large mass stays in place and its damping
                      // prevents drift
    device = {};
    device.mass_kg = kHeld * loop.tool_mass_kg;
    device.damping_n_s_m = 10.0 * device.mass_kg;
  }
  const double least = 0.25 * std::pow(0.1 * shape.radius, 2) / a2, most = shape.reach * shape.reach / a2;
  out.range.least = {range.least.stiffness * least, range.least.damping * least};
  out.range.greatest = {range.greatest.stiffness * most, range.greatest.damping * most};
  return out;
}

ToolContactRange contact_range(const scene::Description& d) {
  const Shape shape = shape_of(d);
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
    const ToolContact least = patch(contact, modulus, disc(0.1 * shape.radius)),
                      most = patch(contact, modulus, shape.largest_area);
    if (least.stiffness < out.least.stiffness) out.least = least;
    if (most.stiffness > out.greatest.stiffness) out.greatest = most;
  }
  if (out.greatest.stiffness <= 0.0)
    fail("{}: haptic stability: no [[contact]] names the tool; say --contact-stiffness-n-m LEAST GREATEST",
         d.name);
  return out;
}

}  // namespace palpate::haptic_stability
