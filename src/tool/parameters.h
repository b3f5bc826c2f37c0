#pragma once
#include "palpate/tool/spec.h"

namespace palpate::tool {

/// What moves, checked: mass [kg] and principal moments about the centre of mass [kg m^2].
struct RigidParameters {
  double mass = 0.0;
  Vec3 inertia = Vec3::Zero();
  Vec3 gravity = Vec3::Zero();  ///< zero where the spec leaves it off [m/s^2]
};

/// Reads and checks the numbers of a spec; an inertia of zero becomes the solid sphere's, 2/5 m r^2.
/// @throws Error naming the key, its value and what it must be
RigidParameters rigid_parameters(const ToolSpec& spec, const Vec3& gravity);

/// @throws Error for principal moments that are no body's, or a mass that is not positive
void check_inertia(double mass, const Vec3& inertia, const char* where);

}  // namespace palpate::tool
