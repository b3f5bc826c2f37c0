#pragma once
#include "tool/rigid_block.h"

namespace palpate::tool {

/// Terms of the scene's tool as one block of the State, computed by Simbody, for monolithic coupling to the
/// bodies. Both terms share one Simbody System.
struct SimbodyTerms {
  std::shared_ptr<dynamics::InertiaTerm> inertia;  ///< M(q) from Simbody's calcM.
  /// Gyroscopic forces and weight, from Simbody's inverse dynamics at u' = 0; the tangent is exact and
  /// unsymmetric.
  std::shared_ptr<dynamics::ForceTerm> force;
};

/// Builds the terms of a tool.
/// @param block_id  a rigid_block of the State
/// @param gravity   [m/s^2]; applies only if spec.gravity is set
/// @throws Error for invalid parameters, naming the key
SimbodyTerms make_simbody_terms(int block_id, const ToolSpec& spec, const Vec3& gravity);

/// Returns the block for this tool. Length scale: the radius (for a mesh, the radius of the solid sphere of
/// the same mean inertia). Speed scale: that radius times the angular frequency sqrt(k/m) of the coupling.
dynamics::BlockSpec tool_block(const ToolSpec& spec);

}  // namespace palpate::tool
