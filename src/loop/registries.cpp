#include "loop/registries.h"
#include "palpate/linear/solvers.h"

#include <fmt/format.h>

#include "contact/gpu_device.h"
#include "contact/methods.h"
#include "palpate/contact/obstacle.h"
#include "palpate/device/device.h"
#include "palpate/device/motions.h"
#include "palpate/device/profile.h"
#include "palpate/device/registry.h"
#include "palpate/fem/laws.h"
#include "palpate/fem/material_presets.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/generators.h"
#include "palpate/tool/tool.h"

namespace palpate::loop {
namespace {

template <class Make>
std::vector<Choice> choices(const Registry<Make>& registry) {
  std::vector<Choice> out;
  for (const auto& entry : registry) out.push_back({entry.name, entry.summary, entry.order});
  return out;
}

template <class Entry>
std::vector<Choice> named(const std::vector<Entry>& registry) {
  std::vector<Choice> out;
  for (const auto& entry : registry) out.push_back({entry.name, entry.summary});
  return out;
}

/// Returns the integrators; the summary is followed by their theoretical properties: family, stability, step
/// control.
std::vector<Choice> stepper_choices() {
  using dynamics::StepControl;
  std::vector<Choice> out;
  for (const auto& entry : integrate::stepper_registry()) {
    const dynamics::StepperTraits& t = entry.traits;
    const char* control = t.control == StepControl::kAdaptive ? "rtol"
                          : t.control == StepControl::kFixed  ? "step_s"
                                                              : "rtol, or step_s";
    const std::string tightest =
        entry.tightest_rtol ? fmt::format(" from {:g}", entry.tightest_rtol({.name = entry.name})) : "";
    out.push_back({entry.name,
                   fmt::format("{} [{}; {}; {}{}]", entry.summary, t.family, dynamics::to_string(t.stability),
                               control, tightest),
                   t.order});
  }
  return out;
}

/// Returns the materials; the summary is preceded by their values.
std::vector<Choice> material_choices() {
  std::vector<Choice> out;
  for (const fem::MaterialPreset& preset : fem::material_presets()) {
    const fem::Material& m = preset.material;
    out.push_back({preset.name, fmt::format("E = {:g} kPa, nu = {:g}, {:g} kg/m^3, stiffness damping {:g} "
                                            "ms: {}. Source: {}",
                                            1e-3 * m.youngs_modulus, m.poissons_ratio, m.density,
                                            1e3 * m.stiffness_damping, preset.summary, preset.source)});
  }
  return out;
}

std::vector<Choice> part_choices() {
  const std::string tool =
      tool::available() ? "compiled in"
                        : "not compiled in; configure with -DPALPATE_WITH_TOOL=ON (package libsimbody-dev)";
  const std::string gl =
      contact::gpu_available()
          ? "compiled in"
          : "not compiled in; configure with -DPALPATE_WITH_GL=ON (packages libegl-dev, libepoxy-dev)";
  return {{"bodies", "soft bodies of linear tetrahedra: always compiled in"},
          {"contact", "penalty contact by nearest points, and with analytic obstacles: always compiled in"},
          {"proxies", "convex proxies of skins, broad and narrow phase (libccd): always compiled in"},
          {"tool", "rigid tool under a virtual coupling (Simbody): " + tool},
          {"gl", "contact images by OpenGL, and pictures (EGL): " + gl}};
}

}  // namespace

const dynamics::StepperRegistry& steppers() { return integrate::stepper_registry(); }

std::vector<Choice> tool_steppers() {
  std::vector<Choice> out;
  for (const tool::ToolIntegratorInfo& info : tool::tool_integrators())
    out.push_back({info.name, info.summary, info.order});
  return out;
}

std::vector<ChoiceList> registries() {
  return {
      {"integrators", "time integrators of soft bodies: [integrator] name, --integrator", stepper_choices()},
      {"linear-solvers", "linear solvers of implicit integrators: [integrator] linear_solver",
       choices(linear::linear_solver_registry())},
      {"materials", "materials with published values: [[body]] and [[body.region]] material",
       material_choices()},
      {"laws", "constitutive laws: [[body]] law", choices(fem::law_registry())},
      {"tool-integrators", "integrators of the haptic ticks: [tool] integrator", tool_steppers()},
      {"obstacles", "rigid shapes in the world: [[obstacle]] type", named(contact::obstacle_registry())},
      {"contact-methods", "methods of gap computation: [[contact]] method",
       named(contact::method_registry())},
      {"contact-springs", "stiffness and damping per area or per vertex: [[contact]] spring",
       named(contact::spring_registry())},
      {"contact-laws", "contact laws, pressure as a function of depth and its rate: [[contact]] law",
       named(contact::law_registry())},
      {"generators", "mesh generators: [body.mesh] generator", choices(mesh::tet_generators())},
      {"devices", "haptic devices: [device] type", choices(device::device_registry())},
      {"device-profiles", "published specifications of devices: [device] profile",
       named(device::device_profiles())},
      {"motions", "motions added to the keyframes: [[device.motion]] kind",
       choices(device::motion_registry())},
      {"parts", "optional parts of this build", part_choices()}};
}

}  // namespace palpate::loop
