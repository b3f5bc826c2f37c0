#include <set>

#include "scene/check.h"
#include "scene/reader.h"

namespace palpate::scene {
namespace {

void check_joint(const Document& doc, const std::string& key, const std::string& where,
                 const JointSpec& joint) {
  const auto has = [&](const char* word) { return given(doc, key + "." + word); };
  check_keyframes(doc, key + ".keyframe", where, joint.keyframes);
  if (!joint.keyframes.empty())
    for (const char* word : {"type", "axis", "stiffness_n_m_rad", "damping_n_m_s_rad"})
      if (has(word))
        refuse(location(doc, key + "." + word), where,
               fmt::format("{} does not apply to a joint with keyframes; remove it", word));
  if (joint.type == JointType::kHinge && !(joint.axis.norm() > 0.0))
    refuse(location(doc, key), where,
           "axis is missing: a hinge needs an axis in the body frame, for example [1.0, 0.0, 0.0]");
  if (has("axis") && joint.type != JointType::kHinge)
    refuse(location(doc, key + ".axis"), where, "axis applies only to type = \"hinge\"; remove it");
  for (const char* word : {"stiffness_n_m_rad", "damping_n_m_s_rad"})
    if (has(word) && (joint.type == JointType::kWeld || joint.type == JointType::kFree))
      refuse(location(doc, key + "." + word), where,
             fmt::format("{} does not apply to type = \"{}\"; remove it", word, name_of(*joint.type)));
}

}  // namespace

// Names of bones are in the model file: references to them are checked when it is read.
void check_skeletons(const Document& doc, const Description& d) {
  for (std::size_t i = 0; i < d.bodies.size(); ++i) {
    const SoftBodySpec& body = d.bodies[i];
    if (!body.skeleton) continue;
    const std::string key = fmt::format("body[{}].skeleton", i),
                      where = fmt::format("body \"{}\": skeleton", body.name);
    if (!body.mesh.has_model())
      refuse(location(doc, key), where,
             "needs mesh = { file = \"MODEL.h5\" }, a model file with bones; `palpate model human -o "
             "human.h5` makes one");
    std::set<std::string> seen;
    for (std::size_t j = 0; j < body.skeleton->joints.size(); ++j) {
      const JointSpec& joint = body.skeleton->joints[j];
      const std::string at = fmt::format("{}.joint[{}]", key, j),
                        of = fmt::format("body \"{}\": joint of \"{}\"", body.name, joint.bone);
      if (!seen.insert(joint.bone).second)
        refuse(location(doc, at + ".bone"), of, "this bone has two joint tables; remove one");
      check_joint(doc, at, of, joint);
    }
  }
}

}  // namespace palpate::scene
