#include <algorithm>

#include "assemble_parts.h"
#include "bones/path.h"
#include "bones/skeleton.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/rigid_body.h"

namespace palpate::loop {
namespace {

/// Returns the block of a free bone, with the error scales of the tissue that it carries: a rotation error
/// counts like the error of a node at a distance of the body's size.
dynamics::BlockSpec block_of(const World& world, const BoneSpec& spec) {
  double length = 0.0, speed = 0.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    for (const AttachmentSpec& attachment : world.description.bodies[i].attachments) {
      if (attachment.to != spec.name) continue;
      const dynamics::Block& tissue = *world.state.layout().find(world.bodies[i].block_id);
      length = std::max(length, tissue.q_scale);
      speed = std::max(speed, tissue.u_scale);
    }
  if (length == 0.0) fail("bone \"{}\" carries no nodes; add a [[body.attachment]] to it", spec.name);
  return dynamics::rigid_block(spec.name, length, speed);
}

void add_free(World& world, Bone& bone, const BoneSpec& spec) {
  const bones::BoneInertia inertia = bones::bone_inertia(spec);
  const Quat r = quaternion_of(spec.rotation_vector_rad);
  VecX q(7), u(6);
  q << r.w(), r.vec(), spec.position_m;
  u << spec.angular_velocity_rad_s, spec.velocity_m_s;
  bone.mass = inertia.mass;
  bone.block_id = world.state.insert(block_of(world, spec), q, u);
  world.system.add(dynamics::make_rigid_inertia(bone.block_id, inertia.mass, inertia.principal));
  world.system.add(dynamics::make_gyroscopic(bone.block_id, inertia.principal));
  if (spec.gravity && !world.description.gravity_m_s2.isZero())
    world.system.add(
        dynamics::make_rigid_weight(bone.block_id, inertia.mass, world.description.gravity_m_s2));
}

/// Directions of the nodes that a bone carries, and their positions in its frame.
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

/// Adds the block and the terms of all freely moving bones, as one tree; returns null if there are none.
std::shared_ptr<const bones::BoneTree> add_tree(World& world, const Body& body, const SoftBodySpec& spec,
                                                std::vector<bones::TreeBone> free, int& block_id) {
  if (free.empty()) return nullptr;
  const auto tree = std::make_shared<const bones::BoneTree>(std::move(free), world.description.gravity_m_s2);
  const dynamics::Block tissue = *world.state.layout().find(body.block_id);
  const Vec3 centre = body.placed * body.masses / body.masses.sum();
  block_id = world.state.insert(tree->block("skeleton of " + spec.name, tissue.q_scale, tissue.u_scale),
                                tree->start(),
                                tree->rigid_start(spec.velocity_m_s, spec.angular_velocity_rad_s, centre));
  world.system.add(bones::make_tree_inertia(block_id, tree));
  world.system.add(bones::make_tree_force(block_id, tree));
  return tree;
}

void assemble_skeleton(World& world, int index) {
  const Body& body = world.bodies[static_cast<std::size_t>(index)];
  const SoftBodySpec& spec = world.description.bodies[static_cast<std::size_t>(index)];
  bones::SkeletonPlan plan = bones::plan_skeleton(
      body.skeleton, *spec.skeleton, quaternion_of(spec.rotation_vector_rad), spec.name, spec.mesh.file);
  int block_id = -1;
  const auto tree = add_tree(world, body, spec, std::move(plan.tree), block_id);
  for (std::size_t b = 0; b < plan.bones.size(); ++b) {
    const bones::SkeletonBone& placed = plan.bones[b];
    const palpate::Bone& in_file = body.skeleton.bones[b];
    Load load = load_of(world, body, static_cast<int>(b), placed.start);
    Bone bone;
    bone.name = spec.name + " " + in_file.name;
    bone.body = index;
    bone.surface = bones::tapered_bone_surface(in_file);
    bone.dofs = load.dofs;
    bone.path = placed.path;
    if (placed.in_tree >= 0) {
      bone.block_id = block_id;
      bone.tree = tree;
      bone.tree_bone = placed.in_tree;
      bone.mass = tree->bone(placed.in_tree).mass;
    }
    if (!load.dofs.empty()) {
      if (placed.in_tree >= 0)
        world.system.add(bones::make_tree_carried(load.dofs, load.local, placed.in_tree, block_id, tree));
      else if (placed.moves)
        world.system.add(fem::make_driven(load.dofs, load.local, placed.path));
      else
        world.system.add(fem::make_fixed(load.dofs, load.x0));
    }
    world.bones.push_back(std::move(bone));
  }
}

}  // namespace

void assemble_bones(World& world) {
  for (const BoneSpec& spec : world.description.bones) {
    Bone bone;
    bone.name = spec.name;
    bone.surface = bones::bone_surface(spec);
    if (spec.fixed || !spec.keyframes.empty())
      bone.path = bones::placed_path(spec);
    else
      add_free(world, bone, spec);
    world.bones.push_back(std::move(bone));
  }
}

void assemble_skeletons(World& world) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    if (world.description.bodies[i].skeleton) assemble_skeleton(world, static_cast<int>(i));
}

}  // namespace palpate::loop
