#include <algorithm>

#include "scene/check.h"
#include "scene/reader.h"

namespace palpate::scene {
namespace {

void check_mesh(const Document& doc, const std::string& key, const std::string& where, const MeshSpec& mesh) {
  if (!mesh.file.empty() && !mesh.generator.empty())
    refuse(location(doc, key + ".generator"), where, "file and generator exclude each other; remove one");
  if (mesh.file.empty() && mesh.generator.empty())
    refuse(location(doc, key), where,
           "needs file = \"PATH\" or generator = \"ball\" (box, ball, cylinder, tet)");
}

}  // namespace

void check_meshes(const Document& doc, const Description& d) {
  for (std::size_t i = 0; i < d.bodies.size(); ++i)
    check_mesh(doc, fmt::format("body[{}].mesh", i), fmt::format("body \"{}\": mesh", d.bodies[i].name),
               d.bodies[i].mesh);
  for (std::size_t i = 0; i < d.bodies.size(); ++i)
    if (d.bodies[i].skin && !d.bodies[i].mesh.has_model())
      refuse(location(doc, fmt::format("body[{}].skin", i)), fmt::format("body \"{}\"", d.bodies[i].name),
             "skin = true needs mesh = { file = \"MODEL.h5\" }, a model file; `palpate model SURFACE -o "
             "MODEL.h5` makes one");
  for (std::size_t i = 0; i < d.bodies.size(); ++i) {
    if (!d.bodies[i].proxies) continue;
    const std::string where = fmt::format("body \"{}\"", d.bodies[i].name),
                      at = location(doc, fmt::format("body[{}].proxies", i));
    if (!d.bodies[i].skin)
      refuse(at, where, "proxies = true needs skin = true: a proxy stands for a part of the skin");
    if (std::none_of(d.contacts.begin(), d.contacts.end(), [&](const ContactSpec& c) {
          return (c.first == d.bodies[i].name || c.second == d.bodies[i].name) && c.method != "analytic";
        }))
      refuse(at, where,
             "proxies = true, but no [[contact]] of this body is in image space, which alone uses them");
  }
  if (!d.tool) return;
  if (given(doc, "tool.mesh"))
    check_mesh(doc, "tool.mesh", "tool: mesh", d.tool->mesh);
  else if (d.tool->shape == "mesh")
    refuse(location(doc, "tool.shape"), "tool", "shape = \"mesh\" needs a [tool.mesh]");
  if (d.tool->shape != "mesh" && given(doc, "tool.mesh"))
    refuse(location(doc, "tool.mesh"), "tool",
           fmt::format("mesh means nothing to shape = \"{}\"; write shape = \"mesh\", or remove it",
                       d.tool->shape));
  if (d.tool->shape == "mesh" && given(doc, "tool.radius_m"))
    refuse(location(doc, "tool.radius_m"), "tool",
           "radius_m means nothing to shape = \"mesh\"; the mesh has its own size");
}

}  // namespace palpate::scene
