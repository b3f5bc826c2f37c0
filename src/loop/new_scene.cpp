#include "loop/new_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "palpate/core/error.h"
#include "palpate/core/keys.h"
#include "palpate/device/profile.h"
#include "palpate/fem/material_presets.h"

namespace palpate::loop {
namespace {

/// Device for which the scene is made: stiffness and force of the coupling stay below its figures.
constexpr const char* kDevice = "omni";
/// Time in which the hand presses, and exchanges in that time.
constexpr double kPress = 0.3, kExchanges = 30.0;  // [s]
/// Share of the device's force that the hand is to reach: the mesh may be stiffer than the half-space.
constexpr double kForceShare = 0.3;
constexpr int kFewestHeld = 12;

const device::DeviceSpecification& device_figures() {
  const auto& all = device::device_profiles();
  const auto found =
      std::find_if(all.begin(), all.end(), [](const auto& profile) { return profile.name == kDevice; });
  PALPATE_CHECK(found != all.end(), "no device profile \"{}\"", kDevice);
  return found->figures;
}

/// Rounds to that many significant digits.
double rounded(double x, int digits) {
  if (!(std::abs(x) > 0.0)) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(x))) - digits + 1);
  return unit * std::round(x / unit);
}

std::string triple(const Vec3& x) {
  std::string out;
  for (int axis = 0; axis < 3; ++axis) {
    std::string one = fmt::format("{:.5g}", std::abs(x[axis]) < 1e-9 ? 0.0 : x[axis]);
    if (one.find_first_of(".e") == std::string::npos) one += ".0";
    out += (axis == 0 ? "" : ", ") + one;
  }
  return "[" + out + "]";
}

/// Measures of the body and the numbers that follow from them.
struct Numbers {
  fem::Material material;
  Vec3 low, high, centre;     ///< Bounding box and centre of volume [m]
  double volume, mass, edge;  ///< [m^3], [kg]; mean edge of the tetrahedra's surface [m]
  double held_height = 0.0;   ///< [m] above `low`
  int held_nodes = 0;
  double radius, stiff, depth, patch, force;  ///< tool [m], E* [Pa], indentation and patch [m], Hertz [N]
  double contact, contact_damping, tool_mass, coupling, coupling_damping, travel;
  Vec3 above;  ///< Start of the tool's way down [m]
};

double mean_edge_of(const TriMesh& surface) {
  double sum = 0.0;
  for (Eigen::Index f = 0; f < surface.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k)
      sum += (surface.vertices.col(surface.faces(k, f)) - surface.vertices.col(surface.faces((k + 1) % 3, f)))
                 .norm();
  return sum / static_cast<double>(3 * surface.faces.cols());
}

/// Chooses the height of the part that is held: a tenth of the body, more where that has too few nodes.
void choose_held_part(const Body& body, Numbers& n) {
  for (double share = 0.1; share < 0.55; share += 0.05) {
    n.held_height = share * (n.high.z() - n.low.z());
    n.held_nodes = static_cast<int>((body.placed.row(2).array() <= n.low.z() + n.held_height).count());
    if (n.held_nodes >= kFewestHeld) return;
  }
}

/// Highest point of a surface on a vertical line, and the upward part of the unit normal there.
struct Top {
  double z = -HUGE_VAL, up = 0.0;
};

Vec3 area_vector(const TriMesh& surface, Eigen::Index face) {
  const auto corner = [&](int k) { return Vec3(surface.vertices.col(surface.faces(k, face))); };
  return (corner(1) - corner(0)).cross(corner(2) - corner(0));
}

/// Returns the top of the surface at (x, y); z is -infinity where the line misses it.
Top top_at(const TriMesh& surface, const Eigen::Vector2d& at) {
  Top out;
  for (Eigen::Index f = 0; f < surface.faces.cols(); ++f) {
    const auto corner = [&](int k) { return surface.vertices.col(surface.faces(k, f)); };
    const Eigen::Vector2d a = corner(0).head<2>(), u = corner(1).head<2>() - a, v = corner(2).head<2>() - a,
                          w = at - a;
    const double det = u.x() * v.y() - u.y() * v.x();
    if (!(det > 0.0)) continue;  // faces down, or is vertical
    const double s = (w.x() * v.y() - w.y() * v.x()) / det, t = (u.x() * w.y() - u.y() * w.x()) / det;
    if (s < 0.0 || t < 0.0 || s + t > 1.0) continue;
    const double z = (1.0 - s - t) * corner(0).z() + s * corner(1).z() + t * corner(2).z();
    if (z > out.z) out = {z, area_vector(surface, f).normalized().z()};
  }
  return out;
}

/// Returns how well the surface supports a tool of that radius at (x, y): 0 where the line misses it, 5 where
/// its top faces up, and lies at a similar height in four directions.
int support_at(const TriMesh& surface, const Eigen::Vector2d& at, double radius) {
  const Top top = top_at(surface, at);
  if (!(top.up > 0.0)) return 0;
  int out = top.up > 0.7 ? 1 : 0;
  for (const Eigen::Vector2d& side :
       {Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(0, -1)})
    out += std::abs(top_at(surface, at + 0.7 * radius * side).z - top.z) < 0.7 * radius;
  return out;
}

/// Chooses the vertical line on which the tool comes down: through the centre of volume where the surface
/// supports it, otherwise through the middle of the face nearest to that line which does, so that the tool
/// does not glance off an edge.
void choose_line(const TriMesh& surface, Numbers& n) {
  constexpr std::size_t kMostTried = 300;
  std::vector<Eigen::Vector2d> tried;
  for (Eigen::Index f = 0; f < surface.faces.cols(); ++f)
    if (const Vec3 area = area_vector(surface, f); area.z() > 0.7 * area.norm())
      tried.emplace_back(surface.vertices(Eigen::all, surface.faces.col(f)).rowwise().mean().head<2>());
  const Eigen::Vector2d centre = n.centre.head<2>();
  std::stable_sort(tried.begin(), tried.end(), [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (a - centre).norm() < (b - centre).norm();
  });
  tried.insert(tried.begin(), centre);
  const std::size_t stride = 1 + tried.size() / kMostTried;
  Eigen::Vector2d line = centre;
  int best = -1;
  for (std::size_t i = 0; i < tried.size() && best < 5; i += stride)
    if (const int support = support_at(surface, tried[i], n.radius); support > best)
      best = support, line = tried[i];
  const double unit = 1e-3 * rounded(n.radius, 1);
  n.above = unit * (Vec3(line.x(), line.y(), n.high.z() + 1.5 * n.radius) / unit).array().round().matrix();
}

Numbers numbers_of(const NewScene& choice, const Body& body) {
  Numbers n{};
  n.material = fem::material_preset(choice.material).material;
  const Points surface = body.surface_points(body.placed);
  n.low = surface.rowwise().minCoeff().cwiseMin(body.placed.rowwise().minCoeff());
  n.high = surface.rowwise().maxCoeff().cwiseMax(body.placed.rowwise().maxCoeff());
  n.volume = body.report.volume;
  n.mass = body.masses.sum();
  n.centre = body.placed * body.masses / n.mass;
  n.edge = mean_edge_of(body.boundary.surface);
  choose_held_part(body, n);
  const double side = std::cbrt(n.volume);
  n.radius = choice.tool_radius > 0.0 ? choice.tool_radius : rounded(std::max(side / 8.0, 1.5 * n.edge), 2);
  const double nu = n.material.poissons_ratio;
  n.stiff = n.material.youngs_modulus / (1.0 - nu * nu);
  const double largest_force = kForceShare * *device_figures().max_force;
  const double by_force = std::pow(0.75 * largest_force / (n.stiff * std::sqrt(n.radius)), 2.0 / 3.0);
  n.depth = rounded(std::min({n.radius / 3.0, (n.high - n.low).minCoeff() / 10.0, by_force}), 2);
  n.patch = std::sqrt(n.radius * n.depth);
  n.force = 4.0 / 3.0 * n.stiff * std::sqrt(n.radius) * std::pow(n.depth, 1.5);
  n.contact = rounded(5.0 * n.stiff / n.patch, 2);
  n.tool_mass = rounded(std::clamp(0.1 * n.mass, 0.01, 0.05), 2);
  const double area = std::numbers::pi * n.patch * n.patch;
  n.contact_damping = rounded(0.1 * 2.0 * std::sqrt(n.contact * n.tool_mass / area), 2);
  n.coupling = rounded(std::min(10.0 * 2.0 * n.stiff * n.patch, *device_figures().max_stiffness), 2);
  n.coupling_damping = rounded(0.9 * 2.0 * std::sqrt(n.coupling * n.tool_mass), 2);
  n.travel = rounded(n.depth + n.force / n.coupling, 3);
  choose_line({surface, body.surface_faces()}, n);
  return n;
}

/// Returns a key with its value and a comment, aligned.
std::string line(const std::string& key, const std::string& value, const std::string& comment) {
  return fmt::format("{:<38} # {}\n", key + " = " + value, comment);
}
std::string line(const std::string& key, double value, const std::string& comment) {
  return line(key, to_toml(std::stod(fmt::format("{:.6g}", value))), comment);
}

/// Returns a text as comment lines of at most 108 characters.
std::string comment(const std::string& text) {
  std::string out, now = "#";
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (now.size() + word.size() > 107) out += now + "\n", now = "#";
    now += " " + word;
  }
  return out + now + "\n";
}

std::string head_text(const NewScene& c, const Numbers& n) {
  const Vec3 size = 1e3 * (n.high - n.low);
  return comment(c.title) + "#\n#   " + c.command +
         "\n#   palpate run THIS_FILE --picture --report        force.csv, picture.png, report.html in out/\n"
         "#   palpate inspect THIS_FILE --picture start.png   sizes, gaps, held nodes\n#\n" +
         comment(
             "Every number below follows from the mesh and the material by the rule beside it; change what "
             "you "
             "know better. `palpate help writing-scenes` explains the rules.") +
         "#\n" +
         comment(
             fmt::format("The body is {:.4g} x {:.4g} x {:.4g} mm large, has {:.4g} cm^3 and {:.3g} kg; the "
                         "mean edge of its elements at the surface is h = {:.3g} mm.",
                         size.x(), size.y(), size.z(), 1e6 * n.volume, n.mass, 1e3 * n.edge)) +
         fmt::format("\n[scene]\nname = \"{}\"\n", c.name) +
         line("duration_s", 3.0 * kPress, fmt::format("press {:g} s, hold, release", kPress));
}

std::string body_text(const NewScene& c, const Numbers& n) {
  std::string out = fmt::format("\n[[body]]\nname = \"{}\"\nmesh = {{ file = \"{}\"", c.name, c.file);
  if (c.scale != 1.0 || c.scale_given) out += fmt::format(", scale = {:g}", c.scale);
  out += " }\n";
  if (c.skin) out += line("skin", "true", "touch the surface of the file, not that of the elements");
  if (!c.rotation_vector.isZero())
    out += line("rotation_vector_rad", triple(c.rotation_vector), "--up: that axis of the file becomes z");
  const fem::MaterialPreset& preset = fem::material_preset(c.material);
  const fem::Material& m = preset.material;
  out += comment(fmt::format("Values of {}: {}. Source: {}.", preset.name, preset.summary, preset.source));
  out += line("material", '"' + preset.name + '"', "palpate list materials");
  out += "# It sets these; a line without # in front takes precedence:\n";
  out += "# " + line("youngs_modulus_pa", m.youngs_modulus, "three times the shear modulus");
  out += "# " + line("poissons_ratio", m.poissons_ratio,
                     "the source: incompressible; plain tetrahedra lock from 0.45 on");
  out += "# " + line("density_kg_m3", m.density, "rho");
  out += "# " + line("stiffness_damping_s", m.stiffness_damping, "viscosity over stiffness");
  const double margin = rounded(0.01 * (n.high - n.low).maxCoeff(), 1);
  const Vec3 beyond = Vec3::Constant(margin);
  out += "\n" +
         comment(fmt::format("The lowest {:.3g} mm are held, {} nodes: a tenth of the height, or more, so "
                             "that at least {} nodes are held.",
                             1e3 * n.held_height, n.held_nodes, kFewestHeld));
  const Vec3 low = n.low - beyond, high(n.high.x() + margin, n.high.y() + margin, n.low.z() + n.held_height);
  return out + "[[body.attachment]]\nbox_min_m = " + triple(low) + "\nbox_max_m = " + triple(high) + "\n";
}

std::string tool_text(const NewScene& c, const Numbers& n) {
  const double inertia = 0.4 * n.tool_mass * n.radius * n.radius,
               turning = rounded(n.coupling * n.radius * n.radius, 2);
  return "\n" +
         comment(
             "A round tool comes down near the middle of the body. start = \"touching\" moves it from "
             "position_m "
             "along start_direction until it touches, and the keyframes below with it.") +
         "[tool]\nshape = \"sphere\"\n" +
         line("radius_m", n.radius,
              c.tool_radius > 0.0 ? "r, as requested"
                                  : "r = max(V^(1/3)/8, 1.5 h): does not sink in between elements") +
         line("mass_kg", n.tool_mass, "m, a tenth of the body, 10 to 50 g: the hand does not feel it swing") +
         line("position_m", triple(n.above), "above a flat place near the middle of the body") +
         "start = \"touching\"\nstart_direction = [0.0, 0.0, -1.0]\n\n" +
         comment("Spring and damper between hand and tool.") + "[tool.coupling]\n" +
         line("stiffness_n_m", n.coupling,
              fmt::format("k = min(10 x 2 E* a, {:g}): ten times the tissue, or the device",
                          *device_figures().max_stiffness)) +
         line("damping_n_s_m", n.coupling_damping, "0.9 x 2 sqrt(k m): nearly critical") +
         line("rotational_stiffness_n_m_rad", turning, "k_r = k r^2: that spring at the tool's surface") +
         line("rotational_damping_n_m_s_rad", rounded(0.9 * 2.0 * std::sqrt(turning * inertia), 2),
              "0.9 x 2 sqrt(k_r 2/5 m r^2)");
}

std::string keyframe(double time, const Vec3& at, const char* what) {
  return "\n[[device.keyframe]]\n" + line("time_s", time, what) + "position_m = " + triple(at) + "\n";
}

std::string hand_text(const Numbers& n) {
  const Vec3 down = n.above - n.travel * Vec3::UnitZ(), up = n.above + 0.5 * n.radius * Vec3::UnitZ();
  return "\n" +
         comment(
             fmt::format("The hand goes down by d + F/k = {:.3g} mm: the indentation d = {:.3g} mm, and the "
                         "extension of the spring.",
                         1e3 * n.travel, 1e3 * n.depth)) +
         fmt::format(
             "#   d = min(r/3, smallest extent/10, depth of {:g} of the device's force)\n"
             "#   F = 4/3 E* sqrt(r) d^1.5 = {:.3g} N   (Hertz 1882, on a half-space)\n"
             "#   E* = E/(1 - nu^2) = {:.4g} Pa\n",
             kForceShare, n.force, n.stiff) +
         comment(
             "A body that yields as a whole gives less force; elements larger than the patch give more.") +
         "[device]\ntype = \"script\"\n" +
         line("max_force_n", *device_figures().max_force,
              "of a common desktop device: palpate list device-profiles") +
         keyframe(0.0, n.above, "at the touch") + keyframe(kPress, down, "press") +
         keyframe(1.6 * kPress, down, "hold") + keyframe(2.6 * kPress, up, "release");
}

std::string contact_text(const NewScene& c, const Numbers& n) {
  const double period = kPress / kExchanges;
  return "\n" +
         comment(
             fmt::format("Contact acts as a layer of springs on the skin. Radius of the patch (Hertz): a = "
                         "sqrt(r d) = {:.3g} mm.",
                         1e3 * n.patch)) +
         fmt::format("[[contact]]\nbetween = [\"{}\", \"tool\"]\n", c.name) +
         line("stiffness_pa_m", n.contact, "k = 5 E*/a: the skins overlap by a tenth of the indentation") +
         line("damping_pa_s_m", n.contact_damping,
              "0.1 x 2 sqrt(k m/(pi a^2)): a tenth of critical; tissue damps, too") +
         line("quadrature_error", 0.01, "contact points: enough to resolve the force to 1 %") + "\n" +
         comment(fmt::format(
             "Tool and body exchange forces {:g} times while the hand presses; 5 to 20 ms are usual.",
             kExchanges)) +
         "[exchange]\n" +
         line("exchange_period_s", period, fmt::format("{:g} s / {:g}", kPress, kExchanges)) +
         line("contact_refresh_s", period, "contact is found anew as often") +
         "\n[integrator]\nname = \"linearly-implicit-euler\"\n" +
         line("step_s", period, "one step per exchange") +
         line("linear_rtol", 1e-4, "errs by far less than the step does") + "\n[record]\n" +
         line("state_period_s", period, "one state per exchange");
}

}  // namespace

scene::Description body_alone(const NewScene& choice, const std::string& path) {
  const fem::Material& m = fem::material_preset(choice.material).material;
  scene::Description out;
  out.name = choice.name;
  out.path = path;
  out.duration_s = 1.0;
  SoftBodySpec& body = out.bodies.emplace_back();
  body.name = choice.name;
  body.mesh.file = choice.file;
  if (choice.scale != 1.0 || choice.scale_given) body.mesh.scale = choice.scale;
  body.skin = choice.skin;
  body.rotation_vector_rad = choice.rotation_vector;
  body.youngs_modulus_pa = m.youngs_modulus;
  body.poissons_ratio = m.poissons_ratio;
  body.density_kg_m3 = m.density;
  return out;
}

std::string new_scene_text(const NewScene& choice, const Body& body) {
  if (!(body.report.volume > 0.0)) fail("{}: the body has no volume", choice.file);
  const Numbers n = numbers_of(choice, body);
  return head_text(choice, n) + body_text(choice, n) + tool_text(choice, n) + hand_text(n) +
         contact_text(choice, n);
}

}  // namespace palpate::loop
