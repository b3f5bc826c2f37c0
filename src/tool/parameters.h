#pragma once
#include "palpate/dynamics/rigid_body.h"
#include "palpate/tool/spec.h"

namespace palpate::tool {

/// The rigid body that moves, checked: mass [kg] and principal moments about the centre of mass [kg m^2].
struct RigidParameters {
  double mass = 0.0;
  Vec3 inertia = Vec3::Zero();
  Vec3 gravity = Vec3::Zero();  ///< zero where the spec leaves it off [m/s^2]
};

/// Reads and checks the numbers of a spec; an inertia of zero becomes the solid sphere's, 2/5 m r^2.
/// @throws Error naming the key, its value and what it must be
RigidParameters rigid_parameters(const ToolSpec& spec, const Vec3& gravity);

using dynamics::check_inertia;

}  // namespace palpate::tool
