#include "experiments/compare/mesh_plan.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "experiments/compare/cells.h"
#include "experiments/compare/plan.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"
#include "scene/contact_sides.h"

namespace palpate::compare {
namespace {

using scene::Description;

constexpr const char* kMeshIntegrator = "linearly-implicit-bdf2";
/// Tolerance of the iterative linear solver; ten times as much in the check, whose error includes it.
constexpr double kMeshLinearRtol = 1e-6;

std::string set_key(const std::string& key, double value) { return key + "=" + toml_number(value); }
std::string set_key(const std::string& key, const std::string& value) { return key + "=\"" + value + '"'; }

std::string in_ms(double s) { return fmt::format("{:.4g} ms", 1e3 * s); }

/// Returns whether the generator makes the finer meshes of a body. Those of a curved body are rounder, and an
/// attachment would hold other parts of it: with attachments, the scene's mesh is divided.
bool keeps_formula(const SoftBodySpec& body) {
  return body.mesh.generator == "box" || body.mesh.generator == "tet" || body.attachments.empty();
}

bool divides_elements(const MeshSpec& mesh) { return !mesh.file.empty() || mesh.generator != "tet"; }

/// Kind of contact, by what limits its accuracy.
enum class Sampling { kPoints, kImage, kFixed };
Sampling sampling_of(const Description& d, ContactSpec contact) {
  contact.method = scene::contact_method(d, contact);
  if (contact.spring != "per_area") return Sampling::kFixed;  // More springs give more force.
  if (scene::is_in_images(contact)) return Sampling::kImage;
  return contact.method == "distance" ? Sampling::kPoints : Sampling::kFixed;
}

bool is_for(const std::string& variable, const char* part) {
  return variable == kTogether || variable == part;
}

void add_meshes(const Description& d, const std::string& variable, int divisions, RefinedMeshes& meshes,
                std::vector<std::string>& out) {
  const std::string folder = std::filesystem::path(d.path).parent_path().string();
  for (std::size_t b = 0; b < d.bodies.size(); ++b) {
    const SoftBodySpec& body = d.bodies[b];
    const std::string key = fmt::format("body.{}.mesh.", b);
    const bool elements = is_for(variable, kElements) && divides_elements(body.mesh);
    const bool skin = is_for(variable, kSkin) && body.skin && !scene::is_in_images(d, body.name);
    if (body.mesh.file.empty()) {
      if (elements && keeps_formula(body))
        out.push_back(set_key(key + "element_size_m", std::ldexp(body.mesh.element_size_m, -divisions)));
      else if (elements)
        out.push_back(fmt::format("body.{}.mesh={{file=\"{}\",scale=1.0}}", b,
                                  meshes.path(body.mesh, folder, divisions, 0)));
    } else if (elements || skin) {
      out.push_back(set_key(key + "file",
                            meshes.path(body.mesh, folder, elements ? divisions : 0, skin ? divisions : 0)));
    }
  }
}

void add_points(const Description& d, int divisions, std::vector<std::string>& out) {
  for (std::size_t i = 0; i < d.contacts.size(); ++i) {
    const ContactSpec& contact = d.contacts[i];
    switch (sampling_of(d, contact)) {
      case Sampling::kPoints:  // The spacing of points is proportional to the root of the error.
        out.push_back(set_key(fmt::format("contact.{}.quadrature_error", i),
                              std::min(std::ldexp(contact.quadrature_error, -2 * divisions),
                                       ContactRanges::quadrature_error.high)));
        break;
      case Sampling::kImage:
        out.push_back(fmt::format("contact.{}.pixels={}", i,
                                  std::lround(std::ldexp(static_cast<double>(contact.pixels), divisions))));
        break;
      case Sampling::kFixed: break;
    }
  }
}

MeshSteps tool_steps(const Description& d, int divisions) {
  MeshSteps out;
  out.step_s = std::ldexp(d.tool->tick_s, -divisions);
  out.made_by =
      fmt::format("{}, tool and bodies as one system, in steps of {}", kMeshIntegrator, in_ms(out.step_s));
  out.overrides = {
      set_key("exchange.scheme", std::string("single_rate")),
      set_key("exchange.contact_refresh_s", out.step_s),
      set_key("exchange.exchange_period_s", out.step_s),
      set_key("integrator.name", std::string(kMeshIntegrator)),
      set_key("integrator.step_s", out.step_s),
      set_key("integrator.linear_rtol", divisions < 0 ? 10.0 * kMeshLinearRtol : kMeshLinearRtol),
      set_key("tool.tick_s", out.step_s)};
  for (std::size_t i = 0; i < d.hands.size(); ++i)
    out.overrides.push_back(set_key(fmt::format("hand.{}.tool.tick_s", i), out.step_s));
  return out;
}

MeshSteps body_steps(const Description& d, int divisions) {
  const dynamics::StepperEntry& entry = *find_stepper(d.integrator.name);
  MeshSteps out;
  out.made_by = entry.name;
  if (entry.traits.stability == dynamics::Stability::kStatic) return out;
  if (!d.contacts.empty())
    out.overrides.push_back(
        set_key("exchange.contact_refresh_s", std::ldexp(d.exchange.contact_refresh_s, -divisions)));
  if (entry.traits.control == dynamics::StepControl::kFixed) {
    out.step_s = std::ldexp(d.integrator.step_s, -divisions);
    out.overrides.push_back(set_key("integrator.step_s", out.step_s));
    out.made_by += " in steps of " + in_ms(out.step_s);
  } else {
    const double rtol = d.integrator.rtol * std::pow(10.0, -1 - divisions);
    out.overrides.push_back(set_key("integrator.rtol", rtol));
    out.made_by += fmt::format(" at rtol {:.2g}", rtol);
  }
  return out;
}

bool is_alike(const KeyframeSpec& a, const KeyframeSpec& b) {
  return a.position_m == b.position_m && a.rotation_vector_rad == b.rotation_vector_rad;
}

}  // namespace

MeshSteps mesh_steps(const Description& d, int divisions) {
  return d.tool ? tool_steps(d, divisions) : body_steps(d, divisions);
}

std::string why_unchanged(const Description& d, const std::string& variable) {
  if (variable == kTogether) {
    std::vector<std::string> changed;
    for (const char* part : {kElements, kSkin, kPoints})
      if (why_unchanged(d, part).empty()) changed.emplace_back(part);
    if (changed.size() != 1) return changed.empty() ? why_unchanged(d, kElements) : "";
    return fmt::format("the {} is the only resolution that can be refined", changed.front());
  }
  const auto any_body = [&](auto has) { return std::any_of(d.bodies.begin(), d.bodies.end(), has); };
  if (variable == kElements && any_body([](const SoftBodySpec& b) { return divides_elements(b.mesh); }))
    return "";
  if (is_for(variable, kSkin) &&
      any_body([&](const SoftBodySpec& b) { return b.skin && !scene::is_in_images(d, b.name); }))
    return "";
  if (variable == kPoints && std::any_of(d.contacts.begin(), d.contacts.end(), [&](const ContactSpec& c) {
        return sampling_of(d, c) != Sampling::kFixed;
      }))
    return "";
  if (variable == kSkin)
    return any_body([](const SoftBodySpec& b) { return b.skin; })
               ? "the proxies of contact in image space list the skin's vertices"
               : "contact uses the boundary of the tetrahedra, which the element size refines";
  if (variable == kPoints)
    return d.contacts.empty() ? "the scene has no [[contact]]"
                              : "contact is sampled at vertices, or its force depends on their number";
  return "the scene has no mesh of more than one element";
}

std::vector<std::string> mesh_overrides(const Description& d, const std::string& variable, int divisions,
                                        RefinedMeshes& meshes) {
  std::vector<std::string> out;
  if (divisions == 0) return out;
  add_meshes(d, variable, divisions, meshes, out);
  if (is_for(variable, kPoints)) add_points(d, divisions, out);
  return out;
}

double end_of_hold(const Description& d, double duration_s) {
  double longest = 0.0, out = kEmpty;
  if (!d.device || d.device->type != "script" || !d.device->motions.empty()) return out;
  const std::vector<KeyframeSpec>& keys = d.device->keyframes;
  for (std::size_t i = 1; i + 1 < keys.size(); ++i) {  // The first interval is before the motion.
    const double rest = keys[i + 1].time_s - keys[i].time_s;
    if (!is_alike(keys[i], keys[i + 1]) || keys[i + 1].time_s > duration_s || rest <= longest) continue;
    longest = rest;
    out = keys[i + 1].time_s;
  }
  // After its last keyframe the handle rests too.
  if (keys.size() > 1 && duration_s - keys.back().time_s > longest) out = duration_s;
  return out;
}

}  // namespace palpate::compare
