#include "bones/skeleton.h"

#include <algorithm>

#include "bones/path.h"
#include "palpate/core/error.h"

namespace palpate::bones {
namespace {

/// Returns the scene's table for the joint of each bone; null: none.
std::vector<const JointSpec*> joints_of(const Skeleton& skeleton, const SkeletonSpec& spec,
                                        const std::string& body, const std::string& file) {
  std::vector<std::string> names;
  for (const Bone& bone : skeleton.bones) names.push_back(bone.name);
  std::vector<const JointSpec*> out(names.size(), nullptr);
  for (const JointSpec& joint : spec.joints) {
    const auto at = std::find(names.begin(), names.end(), joint.bone);
    if (at == names.end())
      fail("body \"{}\": skeleton: {} has no bone \"{}\"{}", body, file, joint.bone,
           suggestion(joint.bone, names));
    out[static_cast<std::size_t>(at - names.begin())] = &joint;
  }
  return out;
}

/// One joint during planning.
struct Link {
  const Bone& bone;
  const JointSpec* own;  ///< null: the skeleton's defaults
  JointType type;
  bool scripted;
  std::string where;  ///< place in the scene, for messages
};

Link link_of(const Bone& bone, const JointSpec* own, const SkeletonSpec& spec, const std::string& body) {
  const JointType otherwise = bone.parent < 0 ? spec.root : spec.others;
  return {bone, own, own ? own->type.value_or(otherwise) : otherwise, own && !own->keyframes.empty(),
          fmt::format("body \"{}\": joint of \"{}\"", body, bone.name)};
}

TreeBone tree_bone(const Link& link, const SkeletonBone& placed, int parent, const SkeletonSpec& spec,
                   const Quat& body_axes) {
  const JointSpec* own = link.own;
  TreeBone bone;
  bone.name = link.bone.name;
  bone.parent = parent;
  bone.joint = link.type;
  bone.start = placed.start;
  bone.mass = spec.density_kg_m3 * placed.shape.volume;
  bone.inertia = bone.mass * placed.shape.unit_moments;
  bone.joint_position = link.bone.head;
  if (own) bone.axis = body_axes * own->axis;
  bone.stiffness = own && own->stiffness_n_m_rad >= 0.0 ? own->stiffness_n_m_rad : spec.stiffness_n_m_rad;
  bone.damping = own && own->damping_n_m_s_rad >= 0.0 ? own->damping_n_m_s_rad : spec.damping_n_m_s_rad;
  return bone;
}

void check_free_bone(const Link& link, const SkeletonSpec& spec, const std::string& body) {
  if (link.type == JointType::kFree && link.bone.parent >= 0)
    fail("{}: type = \"free\" is for a bone without a parent; use \"ball\" or \"hinge\"", link.where);
  if (!(spec.density_kg_m3 > 0.0))
    fail(
        "body \"{}\": skeleton: density_kg_m3 is missing: \"{}\" moves freely; bone has about 800 kg/m^3 "
        "more than the tissue whose mass its nodes have",
        body, link.bone.name);
}

}  // namespace

SkeletonPlan plan_skeleton(const Skeleton& skeleton, const SkeletonSpec& spec, const Quat& body_axes,
                           const std::string& body, const std::string& file) {
  const std::vector<const JointSpec*> joints = joints_of(skeleton, spec, body, file);
  SkeletonPlan plan;
  for (std::size_t i = 0; i < skeleton.bones.size(); ++i) {
    const Link link = link_of(skeleton.bones[i], joints[i], spec, body);
    SkeletonBone bone;
    bone.shape = tapered_bone(link.bone);
    bone.start = bone.shape.frame;
    const SkeletonBone* parent =
        link.bone.parent < 0 ? nullptr : &plan.bones[static_cast<std::size_t>(link.bone.parent)];
    const auto parent_name = [&] { return skeleton.bones[static_cast<std::size_t>(link.bone.parent)].name; };
    const bool parent_prescribed = !parent || parent->in_tree < 0, parent_moves = parent && parent->moves;
    if (link.scripted && !parent_prescribed)
      fail(
          "{}: it has keyframes, but its parent \"{}\" moves freely; give keyframes to all bones up to the "
          "root, or weld them",
          link.where, parent_name());
    if ((link.scripted || link.type == JointType::kWeld) && parent_prescribed) {
      bone.moves = link.scripted || parent_moves;
      bone.path = prescribed_path({bone.start, link.bone.head, body_axes,
                                   link.own ? link.own->keyframes : std::vector<KeyframeSpec>{}},
                                  parent ? parent->path : dynamics::Path{}, parent ? parent->start : Pose{});
    } else {
      if (parent_prescribed && parent_moves)
        fail(
            "{}: a bone that moves freely cannot have the parent \"{}\", which moves by keyframes; weld one "
            "of the two",
            link.where, parent_name());
      check_free_bone(link, spec, body);
      bone.in_tree = static_cast<int>(plan.tree.size());
      // -1 also if the parent has a prescribed motion and is at rest.
      plan.tree.push_back(tree_bone(link, bone, parent ? parent->in_tree : -1, spec, body_axes));
    }
    plan.bones.push_back(std::move(bone));
  }
  return plan;
}

}  // namespace palpate::bones
