#include "fuzz/scene_kinds.h"

#include "palpate/core/named_enum.h"
#include "palpate/device/device.h"
#include "palpate/device/motions.h"
#include "palpate/device/profile.h"
#include "palpate/device/registry.h"
#include "palpate/mesh/generators.h"

namespace palpate::fuzz {
namespace {

using scene::Description;
using scene::Kind;
using scene::KindTable;
using Names = std::vector<std::string>;

template <class Registry>
std::vector<Kind> kinds_of(const Registry& registry) {
  std::vector<Kind> out;
  for (const auto& entry : registry) out.push_back({entry.name, entry.keys});
  return out;
}

std::vector<Kind> named(const Names& names, const Names& keys = {}) {
  std::vector<Kind> out;
  for (const std::string& name : names) out.push_back({name, part_keys(keys)});
  return out;
}

std::vector<Kind> integrators() {
  std::vector<Kind> out = named({"cvode-bdf", "ida", "ark-dirk-esdirk437"},
                                {"rtol", "events", "max_steps", "linear_solver", "linear_rtol", "threads"});
  for (Kind& one : named({"linearly-implicit-euler", "generalized-alpha", "rk4"},
                         {"step_s", "max_steps", "linear_solver", "linear_rtol", "threads"}))
    out.push_back(std::move(one));
  return out;
}

std::vector<Kind> obstacles() {
  const PartKey normal{.name = "normal", .fallback = Vec3(0, 0, 1), .meaning = "outwards"};
  PartKey radius{.name = "radius_m", .range = Range::positive(), .required = true, .meaning = "of it"};
  radius.fallback = 0.1;
  return {
      {"plane", {normal}}, {"sphere", {radius}}, {"box", {{.name = "size_m", .fallback = Vec3(1, 1, 1)}}}};
}

KindTable mesh_kinds(const char* table, std::vector<Kind> generators) {
  generators.push_back({"file", mesh::file_keys()});
  return {.table = table, .selector = "generator", .kinds = std::move(generators), .alternative = "file"};
}

void add_hand(const std::string& prefix, scene::Kinds& out) {
  out.push_back(
      {.table = prefix + "tool", .selector = "integrator", .kinds = named({"semi-implicit-euler"})});
  out.push_back({.table = prefix + "device",
                 .selector = "type",
                 .what = "device type",
                 .kinds = kinds_of(device::device_registry()),
                 .default_kind = [](const Description&) { return DeviceSpec{}.type; }});
  KindTable profiles{.table = prefix + "device", .selector = "profile", .kinds = {}};
  for (const device::DeviceProfile& one : device::device_profiles()) profiles.kinds.push_back({one.name});
  out.push_back(std::move(profiles));
  out.push_back({.table = prefix + "device.motion",
                 .selector = "kind",
                 .kinds = kinds_of(device::motion_registry()),
                 .default_kind = [](const Description&) { return MotionSpec{}.kind; }});
}

scene::Kinds make() {
  scene::Kinds out = {
      {.table = "integrator",
       .selector = "name",
       .kinds = integrators(),
       .default_kind = [](const Description& d) { return d.integrator.name; },
       .lists = {"compare.haptic.integrators"}},
      {.table = "integrator",
       .selector = "linear_solver",
       .kinds = {{"cholmod"}, {"pcg", part_keys({"linear_rtol"})}},
       .default_kind = [](const Description&) { return std::string("cholmod"); }},
      {.table = "body",
       .selector = "law",
       .kinds = {{"corotational", part_keys({"tangent", "volumetric"})}, {"stable_neo_hookean"}},
       .default_kind = [](const Description&) { return SoftBodySpec{}.law; }},
      {.table = "obstacle", .selector = "type", .kinds = obstacles(), .open = true},
      {.table = "contact",
       .selector = "method",
       .kinds = {{"analytic", part_keys({"gaps"})}, {"auto", part_keys({"gaps", "pixels", "samples"})}},
       .absent = {{"vertex", "does not exist"}},
       .default_kind = [](const Description&) { return ContactSpec{}.method; },
       .lists = {"compare.contact_methods"}},
      {.table = "contact", .selector = "spring", .kinds = named({"linear"})},
      {.table = "exchange",
       .selector = "scheme",
       .kinds = {{"partitioned", part_keys({"linearisation", "linearisation_error", "exchange_period_s",
                                            "contact_refresh_s", "latency_ticks"})},
                 {"monolithic", part_keys({"exchange_period_s", "contact_refresh_s"})},
                 {"single_rate", part_keys({"exchange_period_s", "contact_refresh_s"})}},
       .default_kind =
           [](const Description&) { return std::string(name_of(scene::CosimulationSpec{}.scheme)); }},
      mesh_kinds("body.mesh", kinds_of(mesh::tet_generators()))};
  for (const char* table : {"tool.mesh", "hand.tool.mesh"})
    out.push_back(mesh_kinds(table, kinds_of(mesh::surface_generators())));
  for (const std::string prefix : {"", "hand."}) add_hand(prefix, out);
  return out;
}

}  // namespace

const scene::Kinds& scene_kinds() {
  static const scene::Kinds kinds = make();
  return kinds;
}

}  // namespace palpate::fuzz
