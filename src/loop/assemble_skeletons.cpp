#include <algorithm>

#include "assemble_parts.h"
#include "bone_paths.h"
#include "palpate/core/error.h"
#include "palpate/fem/bone.h"

#include "palpate/tool/bone_tree.h"

// Bones of a model file.  Each hangs on its parent by a joint at its head, a root on the world.  A bone
// has a prescribed motion where everything from it up to the world is welded or has keyframes: then it is a
// function of time, and costs no unknown.  All others of a body are one tree in reduced coordinates.

namespace palpate::loop {
namespace {

/// One bone of the file while it is assembled.
struct Entry {
  const palpate::Bone* bone = nullptr;
  const JointSpec* own = nullptr;  ///< the scene's table about its joint; null: none
  std::string type;                ///< of its joint
  fem::TaperedBone shape;
  Pose start;                              ///< of its own frame
  bool prescribed = false, moves = false;  ///< motion is a function of time; and not constant
  fem::Path path;
  int in_tree = -1;
};

std::vector<Entry> entries_of(const Body& body, const SoftBodySpec& spec) {
  const SkeletonSpec& skeleton = *spec.skeleton;
  std::vector<std::string> names;
  for (const palpate::Bone& bone : body.skeleton.bones) names.push_back(bone.name);
  for (const JointSpec& joint : skeleton.joints)
    if (std::find(names.begin(), names.end(), joint.bone) == names.end())
      fail("body \"{}\": skeleton: {} has no bone \"{}\"{}", spec.name, spec.mesh.file, joint.bone,
           suggestion(joint.bone, names));
  std::vector<Entry> out;
  for (const palpate::Bone& bone : body.skeleton.bones) {
    Entry entry;
    entry.bone = &bone;
    for (const JointSpec& joint : skeleton.joints)
      if (joint.bone == bone.name) entry.own = &joint;
    entry.type = entry.own && !entry.own->type.empty() ? entry.own->type
                 : bone.parent < 0                     ? skeleton.root
                                                       : skeleton.others;
    entry.shape = fem::tapered_bone(bone);  // the bone stands in the world already
    entry.start = entry.shape.frame;
    const bool scripted = entry.own && !entry.own->keyframes.empty();
    const Entry* parent = bone.parent < 0 ? nullptr : &out[static_cast<std::size_t>(bone.parent)];
    entry.prescribed = (scripted || entry.type == "weld") && (!parent || parent->prescribed);
    entry.moves = entry.prescribed && (scripted || (parent && parent->moves));
    const std::string where = fmt::format("body \"{}\": joint of \"{}\"", spec.name, bone.name);
    if (scripted && !entry.prescribed)
      fail(
          "{}: it has keyframes, but \"{}\", which it hangs on, moves freely; give keyframes or weld all the "
          "way up to the root",
          where, parent->bone->name);
    if (!entry.prescribed && parent && parent->moves)
      fail(
          "{}: a bone that moves freely cannot hang on \"{}\", which moves by keyframes; weld one of the two",
          where, parent->bone->name);
    out.push_back(std::move(entry));
  }
  return out;
}

/// Directions of the nodes that a bone carries, and where they are in its frame.
struct Load {
  std::vector<int> dofs;
  VecX x0;
  Points local;
};

Load load_of(const World& world, const Body& body, int bone, const Pose& start) {
  std::vector<int> nodes;
  for (std::size_t i = 0; i < body.bone_of_node.size(); ++i)
    if (body.bone_of_node[i] == bone) nodes.push_back(static_cast<int>(i));
  const int first = world.state.layout().find(body.block_id)->u_offset / 3;
  Load out;
  out.dofs = fem::dofs_of_nodes(nodes, first, "xyz");
  out.x0.resize(static_cast<Eigen::Index>(out.dofs.size()));
  out.local.resize(3, out.x0.size());
  for (Eigen::Index i = 0; i < out.x0.size(); ++i) {
    const int dof = out.dofs[static_cast<std::size_t>(i)] - 3 * first;
    out.x0[i] = body.placed(dof % 3, dof / 3);
    out.local.col(i) = start.inverse() * Vec3(body.placed.col(dof / 3));
  }
  return out;
}

tool::TreeBone tree_bone(const Entry& entry, const SoftBodySpec& spec, const std::vector<Entry>& all) {
  const SkeletonSpec& skeleton = *spec.skeleton;
  tool::TreeBone bone;
  bone.name = entry.bone->name;
  // -1 where the parent has a prescribed motion, and stands still
  if (entry.bone->parent >= 0) bone.parent = all[static_cast<std::size_t>(entry.bone->parent)].in_tree;
  bone.joint = entry.type == "hinge"  ? tool::Joint::kHinge
               : entry.type == "ball" ? tool::Joint::kBall
               : entry.type == "free" ? tool::Joint::kFree
                                      : tool::Joint::kWeld;
  bone.start = entry.start;
  bone.mass = skeleton.density_kg_m3 * entry.shape.volume;
  bone.inertia = bone.mass * entry.shape.unit_moments;
  bone.joint_position = entry.bone->head;
  if (entry.own) bone.axis = quaternion_of(spec.rotation_vector_rad) * entry.own->axis;
  bone.stiffness = entry.own && entry.own->stiffness_n_m_rad >= 0.0 ? entry.own->stiffness_n_m_rad
                                                                    : skeleton.stiffness_n_m_rad;
  bone.damping = entry.own && entry.own->damping_n_m_s_rad >= 0.0 ? entry.own->damping_n_m_s_rad
                                                                  : skeleton.damping_n_m_s_rad;
  return bone;
}

/// The tree of all bones that are not prescribed; -1 and null where all are prescribed.
std::pair<int, std::shared_ptr<const tool::BoneTree>> add_tree(World& world, const Body& body,
                                                               const SoftBodySpec& spec,
                                                               std::vector<Entry>& entries) {
  std::vector<tool::TreeBone> bones;
  for (Entry& entry : entries) {
    if (entry.prescribed) continue;
    entry.in_tree = static_cast<int>(bones.size());
    if (entry.type == "free" && entry.bone->parent >= 0)
      fail(
          "body \"{}\": joint of \"{}\": type = \"free\" is for a bone without a parent; use \"ball\" or "
          "\"hinge\"",
          spec.name, entry.bone->name);
    if (!(spec.skeleton->density_kg_m3 > 0.0))
      fail(
          "body \"{}\": skeleton: density_kg_m3 is missing: \"{}\" moves freely; bone has about 800 kg/m^3 "
          "more than the tissue that its nodes weigh",
          spec.name, entry.bone->name);
    bones.push_back(tree_bone(entry, spec, entries));
  }
  if (bones.empty()) return {-1, nullptr};
  const auto tree = std::make_shared<const tool::BoneTree>(std::move(bones), world.description.gravity_m_s2);
  const dynamics::Block tissue = *world.state.layout().find(body.block_id);
  const Vec3 centre = body.placed * body.masses / body.masses.sum();
  const int id = world.state.insert(
      tree->block("skeleton of " + spec.name, tissue.q_scale, tissue.u_scale), tree->start(),
      tree->rigid_start(spec.velocity_m_s, spec.angular_velocity_rad_s, centre));
  world.system.add(tool::make_tree_inertia(id, tree));
  world.system.add(tool::make_tree_force(id, tree));
  return {id, tree};
}

void assemble_skeleton(World& world, int index) {
  const Body& body = world.bodies[static_cast<std::size_t>(index)];
  const SoftBodySpec& spec = world.description.bodies[static_cast<std::size_t>(index)];
  std::vector<Entry> entries = entries_of(body, spec);
  for (Entry& entry : entries) {
    if (!entry.prescribed) continue;
    const Entry* parent =
        entry.bone->parent < 0 ? nullptr : &entries[static_cast<std::size_t>(entry.bone->parent)];
    entry.path = prescribed_path({entry.start, entry.bone->head, quaternion_of(spec.rotation_vector_rad),
                                  entry.own ? entry.own->keyframes : std::vector<KeyframeSpec>{}},
                                 parent ? parent->path : fem::Path{}, parent ? parent->start : Pose{});
  }
  const auto [block_id, tree] = add_tree(world, body, spec, entries);
  for (std::size_t b = 0; b < entries.size(); ++b) {
    const Entry& entry = entries[b];
    Load load = load_of(world, body, static_cast<int>(b), entry.start);
    Bone bone;
    bone.name = spec.name + " " + entry.bone->name;
    bone.body = index;
    bone.surface = fem::tapered_bone_surface(*entry.bone);
    bone.dofs = load.dofs;
    bone.path = entry.path;
    if (!entry.prescribed) {
      bone.block_id = block_id;
      bone.tree = tree;
      bone.tree_bone = entry.in_tree;
      bone.mass = tree->bone(entry.in_tree).mass;
    }
    if (!load.dofs.empty()) {
      if (entry.prescribed && !entry.moves)
        world.system.add(fem::make_fixed(load.dofs, load.x0));
      else if (entry.prescribed)
        world.system.add(fem::make_driven(load.dofs, load.local, entry.path));
      else
        world.system.add(tool::make_tree_carried(load.dofs, load.local, entry.in_tree, block_id, tree));
    }
    world.bones.push_back(std::move(bone));
  }
}

}  // namespace

void assemble_skeletons(World& world) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    if (world.description.bodies[i].skeleton) assemble_skeleton(world, static_cast<int>(i));
}

}  // namespace palpate::loop
