#pragma once
#include "palpate/tool/rigid_block.h"

namespace palpate::tool {

/// The scene's tool as a block of the State, its right-hand side by Simbody, for monolithic coupling beside
/// the bodies.  One Simbody System stands behind both terms.
struct SimbodyTerms {
  std::shared_ptr<dynamics::InertiaTerm> inertia;  ///< M(q) by Simbody's calcM
  /// gyroscopic forces and weight, by Simbody's inverse dynamics at u' = 0; with its exact, unsymmetric
  /// tangent
  std::shared_ptr<dynamics::ForceTerm> force;
};

/// @param block_id  a rigid_block of the State
/// @param gravity   [m/s^2]; counts only where the spec gives the tool its weight
/// @throws Error for numbers that no tool can have, naming the key
SimbodyTerms make_simbody_terms(int block_id, const ToolSpec& spec, const Vec3& gravity);

/// The block that such a tool needs, its scales in the coupling's own units: the radius (of a mesh: of the
/// solid sphere with its inertia), and that radius a time of the coupling's oscillation, 2 pi left out.
dynamics::BlockSpec tool_block(const ToolSpec& spec);

}  // namespace palpate::tool
