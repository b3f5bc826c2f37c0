#pragma once
#include <string>

#include "palpate/core/error.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/loop/world.h"

namespace palpate::scene_checks {

/// Returns the message with which a scene is rejected.
inline std::string refusal(const scene::Description& d) {
  try {
    loop::assemble(d);
  } catch (const Error& e) { return e.what(); }
  return "not refused";
}

/// Momentum (angular about the origin, linear) of nodes and bones.
/// @param inertia_of_bones  three principal moments per bone about its axes [kg m^2]; empty where negligible
inline Vec6 momentum(const loop::World& world, const VecX& inertia_of_bones = {}) {
  Vec6 out = Vec6::Zero();
  const auto add = [&](double m, const Vec3& x, const Vec3& v) {
    out.head<3>() += m * x.cross(v);
    out.tail<3>() += m * v;
  };
  for (const loop::Body& body : world.bodies)
    for (int i = 0; i < body.masses.size(); ++i)
      add(body.masses[i], world.state.view().position(i), world.state.view().velocity(i));
  for (std::size_t b = 0; b < world.bones.size(); ++b) {
    const Pose pose = world.bone_pose(world.bones[b]);
    const Twist twist = world.bone_twist(world.bones[b]);
    add(world.bones[b].mass, pose.translation, twist.linear);
    if (inertia_of_bones.size() > 0)
      out.head<3>() +=
          dynamics::world_inertia(pose, inertia_of_bones.segment<3>(3 * static_cast<Eigen::Index>(b))) *
          twist.angular;
  }
  return out;
}

}  // namespace palpate::scene_checks
