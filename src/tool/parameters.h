#pragma once
#include "palpate/dynamics/rigid_body.h"
#include "palpate/tool/spec.h"

namespace palpate::tool {

/// Checked parameters of the rigid body: mass [kg] and principal moments of inertia about the centre of mass
/// [kg m^2].
struct RigidParameters {
  double mass = 0.0;
  Vec3 inertia = Vec3::Zero();
  Vec3 gravity = Vec3::Zero();  ///< Zero if the spec has gravity off [m/s^2].
};

/// Reads and checks the parameters of a spec; a zero inertia is replaced by the solid sphere's, 2/5 m r^2.
/// @throws Error with the key, its value and the valid range
RigidParameters rigid_parameters(const ToolSpec& spec, const Vec3& gravity);

using dynamics::check_inertia;

}  // namespace palpate::tool
