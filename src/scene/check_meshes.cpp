#include <algorithm>

#include "palpate/scene/hands.h"
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

void check_tool_mesh(const Document& doc, const Hand& hand) {
  const std::string key = hand.tool_key + ".mesh",
                    where = hand.name == "tool" ? "tool" : fmt::format("hand \"{}\": tool", hand.name);
  const ToolShape shape = hand.tool->shape;
  if (given(doc, key))
    check_mesh(doc, key, where + ": mesh", hand.tool->mesh);
  else if (shape == ToolShape::kMesh)
    refuse(
        location(doc, hand.tool_key + ".shape"), where,
        fmt::format("shape = \"mesh\" needs a [{}]", hand.name == "tool" ? "tool.mesh" : "hand.tool.mesh"));
  if (shape != ToolShape::kMesh && given(doc, key))
    refuse(location(doc, key), where,
           fmt::format("mesh does not apply to shape = \"{}\"; write shape = \"mesh\", or remove it",
                       name_of(shape)));
  if (shape == ToolShape::kMesh && given(doc, hand.tool_key + ".radius_m"))
    refuse(location(doc, hand.tool_key + ".radius_m"), where,
           "radius_m does not apply to shape = \"mesh\", which has the size of its mesh; remove it");
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
      refuse(at, where, "proxies = true needs skin = true: proxies represent parts of the skin");
    if (std::none_of(d.contacts.begin(), d.contacts.end(), [&](const ContactSpec& c) {
          return (c.first == d.bodies[i].name || c.second == d.bodies[i].name) && c.method != "analytic";
        }))
      refuse(
          at, where,
          "proxies = true, but only contact in image space uses proxies and this body has none; remove it");
  }
  for (const Hand& hand : hands_of(d)) check_tool_mesh(doc, hand);
}

}  // namespace palpate::scene
