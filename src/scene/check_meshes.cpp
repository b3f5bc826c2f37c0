#include <algorithm>

#include "scene/check.h"
#include "scene/reader.h"

namespace palpate::scene {
namespace {

/// Which keys each source of a mesh reads.  Any other key would be ignored in silence, so it is refused;
/// `needs` must be there.
struct SourceKeys {
  std::string source;
  Names needs, takes;
};

const std::vector<SourceKeys>& source_keys() {
  static const std::vector<SourceKeys> table = {
      {"box", {"size_m", "element_size_m"}, {"grading"}},
      {"ball", {"radius_m", "element_size_m"}, {"grading"}},
      {"cylinder", {"radius_m", "length_m", "element_size_m"}, {"grading"}},
      {"tet", {"size_m"}, {}},
      {"file", {}, {"scale"}},
  };
  return table;
}

bool has(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void check_mesh(const Document& doc, const std::string& key, const std::string& where, const MeshSpec& mesh) {
  if (!mesh.file.empty() && !mesh.generator.empty())
    refuse(place(doc, key + ".generator"), where, "file and generator exclude each other; remove one");
  if (mesh.file.empty() && mesh.generator.empty())
    refuse(place(doc, key), where,
           "needs file = \"PATH\" or generator = \"ball\" (box, ball, cylinder, tet)");

  const std::string source = mesh.file.empty() ? mesh.generator : "file";
  const auto found = std::find_if(source_keys().begin(), source_keys().end(),
                                  [&](const SourceKeys& s) { return s.source == source; });
  const std::string subject = mesh.file.empty() ? "generator = \"" + source + "\"" : "a mesh from a file";
  for (const std::string& name : found->needs)
    if (!given(doc, key + "." + name))
      refuse(place(doc, key), where, fmt::format("{} is missing: {} needs it", name, subject));
  for (const char* name : {"size_m", "radius_m", "length_m", "element_size_m", "grading", "scale"})
    if (given(doc, key + "." + name) && !has(found->needs, name) && !has(found->takes, name))
      refuse(place(doc, key + "." + name), where,
             fmt::format("{} means nothing to {}; remove it", name, subject));
}

}  // namespace

void check_meshes(const Document& doc, const Description& d) {
  for (std::size_t i = 0; i < d.bodies.size(); ++i)
    check_mesh(doc, fmt::format("body[{}].mesh", i), fmt::format("body \"{}\": mesh", d.bodies[i].name),
               d.bodies[i].mesh);
  for (std::size_t i = 0; i < d.bodies.size(); ++i)
    if (d.bodies[i].skin && !d.bodies[i].mesh.file.ends_with(".h5"))
      refuse(place(doc, fmt::format("body[{}].skin", i)), fmt::format("body \"{}\"", d.bodies[i].name),
             "skin = true needs mesh = { file = \"MODEL.h5\" }, a model file; `palpate model SURFACE -o "
             "MODEL.h5` makes one");
  for (std::size_t i = 0; i < d.bodies.size(); ++i) {
    if (!d.bodies[i].proxies) continue;
    const std::string where = fmt::format("body \"{}\"", d.bodies[i].name),
                      at = place(doc, fmt::format("body[{}].proxies", i));
    if (!d.bodies[i].skin)
      refuse(at, where, "proxies = true needs skin = true: a proxy stands for a part of the skin");
    if (std::none_of(d.contacts.begin(), d.contacts.end(), [&](const ContactSpec& c) {
          return (c.first == d.bodies[i].name || c.second == d.bodies[i].name) && c.method == "gpu";
        }))
      refuse(at, where,
             "proxies = true, but no [[contact]] of this body has method = \"gpu\", which alone uses them");
  }
  if (!d.tool) return;
  if (given(doc, "tool.mesh"))
    check_mesh(doc, "tool.mesh", "tool: mesh", d.tool->mesh);
  else if (d.tool->shape == "mesh")
    refuse(place(doc, "tool.shape"), "tool", "shape = \"mesh\" needs a [tool.mesh]");
  if (d.tool->shape == "mesh" && given(doc, "tool.radius_m"))
    refuse(place(doc, "tool.radius_m"), "tool",
           "radius_m means nothing to shape = \"mesh\"; the mesh has its own size");
}

}  // namespace palpate::scene
