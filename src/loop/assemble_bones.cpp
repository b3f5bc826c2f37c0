#include <algorithm>

#include "assemble_parts.h"
#include "palpate/core/error.h"
#include "palpate/device/handle.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/fem/bone.h"

namespace palpate::loop {
namespace {

/// Keyframes move a bone from where it is placed: X(t) = (R(t) R0, p0 + p(t)).
fem::Path path_of(const BoneSpec& spec) {
  const Pose placed{quaternion_of(spec.rotation_vector_rad), spec.position_m};
  if (spec.fixed) return [placed](double) { return fem::PathPoint{placed, {}, {}}; };
  return [keyframes = spec.keyframes, placed](double t) {
    const device::HandleSample s = device::sample_keyframes(keyframes, t);
    return fem::PathPoint{{s.pose.rotation * placed.rotation, s.pose.translation + placed.translation},
                          s.twist,
                          s.acceleration};
  };
}

/// The block of a free bone, with error scales in the units of the tissue that it carries: an error of its
/// rotation counts as that of a node a body's size away.
dynamics::BlockSpec block_of(const World& world, const BoneSpec& spec) {
  double length = 0.0, speed = 0.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    for (const AttachmentSpec& attachment : world.description.bodies[i].attachments) {
      if (attachment.to != spec.name) continue;
      const dynamics::Block& tissue = *world.state.layout().find(world.bodies[i].block_id);
      length = std::max(length, tissue.q_scale);
      speed = std::max(speed, tissue.u_scale);
    }
  if (length == 0.0) fail("bone \"{}\": carries nothing: give a body an attachment to it", spec.name);
  return dynamics::rigid_block(spec.name, length, speed);
}

void add_free(World& world, Bone& bone, const BoneSpec& spec) {
  const fem::BoneInertia inertia = fem::bone_inertia(spec);
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

}  // namespace

void assemble_bones(World& world) {
  for (const BoneSpec& spec : world.description.bones) {
    Bone bone;
    bone.name = spec.name;
    bone.surface = fem::bone_surface(spec);
    if (spec.fixed || !spec.keyframes.empty())
      bone.path = path_of(spec);
    else
      add_free(world, bone, spec);
    world.bones.push_back(std::move(bone));
  }
}

}  // namespace palpate::loop
