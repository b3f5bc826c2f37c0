#include "palpate/loop/load.h"

#include <fmt/format.h>

#include "contact/methods.h"
#include "loop/registries.h"
#include "palpate/contact/obstacle.h"
#include "palpate/core/named_enum.h"
#include "palpate/device/device.h"
#include "palpate/device/motions.h"
#include "palpate/device/profile.h"
#include "palpate/device/registry.h"
#include "palpate/fem/laws.h"
#include "palpate/fem/material_presets.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "palpate/mesh/generators.h"
#include "palpate/tool/tool.h"
#include "store/model_cache.h"

namespace palpate::loop {
namespace {

using scene::Description;
using scene::Kind;
using scene::KindTable;

template <class Registry>
std::vector<Kind> kinds_of(const Registry& registry) {
  std::vector<Kind> out;
  for (const auto& entry : registry) out.push_back({entry.name, entry.keys});
  return out;
}

KindTable mesh_kinds(const char* table, std::vector<Kind> generators) {
  generators.push_back({"file", mesh::file_keys()});
  return {.table = table, .selector = "generator", .kinds = std::move(generators), .alternative = "file"};
}

/// Returns the presets of a material, with the values that they give to the keys of the table.
KindTable material_kinds(const char* table) {
  KindTable out{.table = table, .selector = "material", .kinds = {}};
  for (const fem::MaterialPreset& preset : fem::material_presets()) {
    const fem::Material& m = preset.material;
    out.kinds.push_back({.name = preset.name,
                         .values = {{"youngs_modulus_pa", m.youngs_modulus},
                                    {"poissons_ratio", m.poissons_ratio},
                                    {"density_kg_m3", m.density},
                                    {"stiffness_damping_s", m.stiffness_damping}}});
  }
  for (const auto& law : fem::law_registry())
    out.absent.push_back(
        {law.name, fmt::format("is a constitutive law: write law = \"{}\" in [[body]]", law.name)});
  return out;
}

/// Adds the tables of [tool] and [device], or, with the prefix "hand.", of each [[hand]].
void add_hand(const std::string& prefix, scene::Kinds& out) {
  KindTable tool_integrators{.table = prefix + "tool",
                             .selector = "integrator",
                             .what = "tool integrator",
                             .kinds = {},
                             .default_kind = [](const Description&) { return ToolSpec{}.integrator; }};
  for (const tool::ToolIntegratorInfo& info : tool::tool_integrators())
    tool_integrators.kinds.push_back({info.name});
  // Without Simbody there are none: assemble() reports the package that provides tools.
  if (!tool_integrators.kinds.empty()) out.push_back(std::move(tool_integrators));
  out.push_back({.table = prefix + "device",
                 .selector = "type",
                 .what = "device type",
                 .kinds = kinds_of(device::device_registry()),
                 .default_kind = [](const Description&) { return DeviceSpec{}.type; }});
  KindTable profiles{
      .table = prefix + "device", .selector = "profile", .what = "device profile", .kinds = {}};
  for (const device::DeviceProfile& one : device::device_profiles()) profiles.kinds.push_back({one.name});
  out.push_back(std::move(profiles));
  out.push_back({.table = prefix + "device.motion",
                 .selector = "kind",
                 .what = "motion",
                 .kinds = kinds_of(device::motion_registry()),
                 .default_kind = [](const Description&) { return MotionSpec{}.kind; }});
}

scene::Kinds make_kinds() {
  scene::Kinds out;
  out.push_back({.table = "integrator",
                 .selector = "name",
                 .what = "integrator",
                 .kinds = kinds_of(integrate::stepper_registry()),
                 .default_kind = [](const Description& d) { return d.integrator.name; },
                 .lists = {"compare.haptic.integrators"}});
  out.push_back(
      {.table = "integrator",
       .selector = "linear_solver",
       .what = "linear solver",
       .kinds = kinds_of(linear::linear_solver_registry()),
       .default_kind = [](const Description& d) { return integrate::linear_solver_of(d.integrator); }});
  out.push_back({.table = "body",
                 .selector = "law",
                 .kinds = kinds_of(fem::law_registry()),
                 .default_kind = [](const Description&) { return SoftBodySpec{}.law; }});
  for (const char* table : {"body", "body.region"}) out.push_back(material_kinds(table));
  out.push_back(mesh_kinds("body.mesh", kinds_of(mesh::tet_generators())));
  for (const char* table : {"tool.mesh", "hand.tool.mesh"})
    out.push_back(mesh_kinds(table, kinds_of(mesh::surface_generators())));
  out.push_back({.table = "obstacle",
                 .selector = "type",
                 .kinds = kinds_of(contact::obstacle_registry()),
                 .open = true});
  KindTable methods{.table = "contact",
                    .selector = "method",
                    .kinds = kinds_of(contact::method_registry()),
                    .default_kind = [](const Description&) { return ContactSpec{}.method; },
                    .lists = {"compare.contact_methods"}};
  for (const contact::AbsentMethod& one : contact::absent_methods())
    methods.absent.push_back({one.name, one.answer});
  out.push_back(std::move(methods));
  out.push_back({.table = "contact",
                 .selector = "spring",
                 .kinds = kinds_of(contact::spring_registry()),
                 .default_kind = [](const Description&) { return ContactSpec{}.spring; }});
  out.push_back({.table = "contact",
                 .selector = "law",
                 .kinds = kinds_of(contact::law_registry()),
                 .default_kind = [](const Description&) { return ContactSpec{}.law; }});
  const std::vector<PartKey> partitioned_keys = part_keys(
      {"linearisation", "linearisation_error", "exchange_period_s", "contact_refresh_s", "latency_ticks"});
  out.push_back({.table = "exchange",
                 .selector = "scheme",
                 .kinds = {{"partitioned", partitioned_keys},
                           {"monolithic", part_keys({"exchange_period_s", "contact_refresh_s"})},
                           {"single_rate", part_keys({"exchange_period_s", "contact_refresh_s"})},
                           {"auto", partitioned_keys}},
                 .default_kind = [](const Description&) {
                   return std::string(name_of(scene::CosimulationSpec{}.scheme));
                 }});
  out.push_back({.table = "exchange",
                 .selector = "tunnelling",
                 .kinds = {{"report"}, {"substep", part_keys({"shortest_refresh_s"})}},
                 .default_kind = [](const Description&) {
                   return std::string(name_of(scene::CosimulationSpec{}.tunnelling));
                 }});
  for (const std::string prefix : {"", "hand."}) add_hand(prefix, out);
  return out;
}

}  // namespace

const scene::Kinds& kinds() {
  static const scene::Kinds kinds = make_kinds();
  return kinds;
}

scene::Description with_cached_models(scene::Description d) {
  const auto take = [](MeshSpec& mesh) {
    if (const std::string name = store::model_of(mesh.file); !name.empty())
      mesh.file = store::cached_model(name);
  };
  for (SoftBodySpec& body : d.bodies) take(body.mesh);
  if (d.tool) take(d.tool->mesh);
  for (scene::HandSpec& hand : d.hands) take(hand.tool.mesh);
  return d;
}

scene::Description load(const std::string& path, const std::vector<std::string>& overrides) {
  return with_cached_models(scene::load(path, overrides, kinds()));
}

scene::Description parse(const std::string& text, const std::string& path,
                         const std::vector<std::string>& overrides) {
  return with_cached_models(scene::parse(text, path, overrides, kinds()));
}

}  // namespace palpate::loop
