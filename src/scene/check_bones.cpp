#include <algorithm>

#include "palpate/scene/hands.h"
#include "scene/check.h"
#include "scene/reader.h"

namespace palpate::scene {
namespace {

/// Key of a shape, and whether a shape needs it.
struct ShapeKey {
  const char* word;
  bool (*of)(BoneShape shape);
};
constexpr ShapeKey kShapeKeys[] = {
    {"radius_m", [](BoneShape shape) { return shape != BoneShape::kBox; }},
    {"length_m",
     [](BoneShape shape) { return shape == BoneShape::kCylinder || shape == BoneShape::kCapsule; }},
    {"size_m", [](BoneShape shape) { return shape == BoneShape::kBox; }}};

void check_shape(const Document& doc, const std::string& key, const std::string& where,
                 const BoneSpec& bone) {
  for (const auto& [word, of] : kShapeKeys) {
    const bool has = given(doc, key + "." + word), fits = bone.shape && of(*bone.shape);
    if (has && !fits)
      refuse(location(doc, key + "." + word), where,
             !bone.shape
                 ? fmt::format("{} needs a shape; add shape = \"capsule\" (sphere, box, cylinder, capsule)",
                               word)
                 : fmt::format("{} does not apply to shape = \"{}\"; remove it", word, name_of(*bone.shape)));
    if (fits && !has)
      refuse(location(doc, key), where,
             fmt::format("{} is missing: shape = \"{}\" needs it", word, name_of(*bone.shape)));
  }
}

/// Rejects keys that apply only to free bones, for a bone whose motion is prescribed.
void check_prescribed(const Document& doc, const std::string& key, const std::string& where,
                      const BoneSpec& bone) {
  const char* kind = bone.fixed ? "a fixed bone" : "a bone with keyframes";
  for (const char* word :
       {"mass_kg", "density_kg_m3", "inertia_kg_m2", "velocity_m_s", "angular_velocity_rad_s", "gravity"})
    if (given(doc, key + "." + word))
      refuse(location(doc, key + "." + word), where,
             fmt::format("{} does not apply to {}; remove it", word, kind));
}

void check_free(const Document& doc, const std::string& key, const std::string& where, const BoneSpec& bone) {
  const bool mass = given(doc, key + ".mass_kg"), density = given(doc, key + ".density_kg_m3"),
             inertia = given(doc, key + ".inertia_kg_m2");
  if (mass && density)
    refuse(location(doc, key + ".density_kg_m3"), where,
           "mass_kg and density_kg_m3 exclude each other; remove one");
  if (density && !bone.shape)
    refuse(location(doc, key + ".density_kg_m3"), where,
           "density_kg_m3 needs a shape; give mass_kg and inertia_kg_m2 instead");
  if (!mass && !density)
    refuse(location(doc, key), where,
           "mass_kg (or density_kg_m3 of its shape) is missing; a bone that does not move needs fixed = true "
           "or a [[bone.keyframe]]");
  if (!bone.shape && !inertia)
    refuse(location(doc, key), where,
           "inertia_kg_m2 is missing: a bone without a shape has no default inertia");
  const Vec3& I = bone.inertia_kg_m2;
  if (inertia && 2.0 * I.maxCoeff() > I.sum() * (1.0 + 1e-9))
    refuse(location(doc, key + ".inertia_kg_m2"), where,
           fmt::format("inertia_kg_m2 = [{}, {}, {}] is not the inertia of a rigid body: none may be larger "
                       "than the sum of the other two",
                       I[0], I[1], I[2]));
}

bool carries(const Description& d, const std::string& name) {
  return std::any_of(d.bodies.begin(), d.bodies.end(), [&](const SoftBodySpec& body) {
    return std::any_of(body.attachments.begin(), body.attachments.end(),
                       [&](const AttachmentSpec& a) { return a.to == name; });
  });
}

void check_target(const Document& doc, const std::string& key, const std::string& where, const Description& d,
                  const AttachmentSpec& a) {
  const std::string at = location(doc, key + ".to");
  if (a.to == "tool") {
    if (!d.tool) refuse(at, where, "to = \"tool\", but the scene has no [tool]");
  } else if (!tool_named(d, a.to)) {
    Names names;
    for (const BoneSpec& bone : d.bones) names.push_back(bone.name);
    const bool known = std::find(names.begin(), names.end(), a.to) != names.end();
    for (const Hand& hand : hands_of(d)) names.push_back(hand.name);
    if (!known && names.empty())
      refuse(at, where, fmt::format("to = \"{}\", but the scene has no [[bone]]", a.to));
    if (!known)
      refuse(at, where,
             fmt::format("no bone{} is called \"{}\"{}", d.tool ? " and no tool" : "", a.to,
                         suggestion(a.to, names)));
  }
  if (given(doc, key + ".axes"))
    refuse(location(doc, key + ".axes"), where,
           "axes does not apply with to: nodes carried by a bone are held in all directions; remove it");
  if (!a.keyframes.empty())
    refuse(location(doc, key + ".keyframe"), where,
           fmt::format("keyframes do not apply with to: the nodes move with \"{}\"; give the keyframes to it",
                       a.to));
}

/// Returns the way in which an attachment selects nodes.
Selection region_of(const Document& doc, const std::string& key, const std::string& where,
                    const Description& d, const AttachmentSpec& a) {
  if (const auto shape = box_or_sphere(doc, key, where)) return *shape;
  if (a.to.empty())
    refuse(location(doc, key), where,
           "box_min_m is missing; select nodes by box_min_m and box_max_m, or by centre_m and radius_m");
  const auto bone =
      std::find_if(d.bones.begin(), d.bones.end(), [&](const BoneSpec& b) { return b.name == a.to; });
  if (bone != d.bones.end() ? !bone->shape : tool_named(d, a.to)->shape != ToolShape::kSphere)
    refuse(location(doc, key), where,
           fmt::format("the nodes are not selected, as \"{}\" has no shape; give box_min_m and box_max_m, or "
                       "centre_m and radius_m",
                       a.to));
  return Selection::kShape;
}

}  // namespace

void check_bones(const Document& doc, const Description& d) {
  for (std::size_t i = 0; i < d.bones.size(); ++i) {
    const BoneSpec& bone = d.bones[i];
    const std::string key = fmt::format("bone[{}]", i), where = fmt::format("bone \"{}\"", bone.name);
    check_shape(doc, key, where, bone);
    if (bone.fixed && !bone.keyframes.empty())
      refuse(location(doc, key + ".fixed"), where,
             "fixed = true and keyframes exclude each other; remove one");
    if (bone.fixed || !bone.keyframes.empty())
      check_prescribed(doc, key, where, bone);
    else
      check_free(doc, key, where, bone);
    check_keyframes(doc, key + ".keyframe", where, bone.keyframes);
    if (!carries(d, bone.name))
      refuse(location(doc, key), where,
             fmt::format("carries no nodes; give a body a [[body.attachment]] with to = \"{}\"", bone.name));
  }
}

void check_attachments(const Document& doc, Description& d) {
  for (std::size_t i = 0; i < d.bodies.size(); ++i)
    for (std::size_t j = 0; j < d.bodies[i].attachments.size(); ++j) {
      AttachmentSpec& a = d.bodies[i].attachments[j];
      const std::string key = fmt::format("body[{}].attachment[{}]", i, j),
                        where = fmt::format("body \"{}\": attachment[{}]", d.bodies[i].name, j);
      if (!a.to.empty()) check_target(doc, key, where, d, a);
      a.region = region_of(doc, key, where, d, a);
      check_box(doc, key, where, a.box_min_m, a.box_max_m);
      check_keyframes(doc, key + ".keyframe", where, a.keyframes);
    }
}

}  // namespace palpate::scene
