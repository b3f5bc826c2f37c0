#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "palpate/core/pose.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/tool/spec.h"

/// A tool as a rigid block of the State, for monolithic coupling to soft bodies under any of their
/// integrators. This header does not need Simbody; simbody_block.h has the block with Simbody terms.
namespace palpate::tool {

using dynamics::make_gyroscopic;
using dynamics::make_rigid_inertia;
using dynamics::make_rigid_weight;
using dynamics::rigid_block;

/// Pose and twist of a handle at one time.
struct HandleState {
  Pose pose;
  Twist twist;
};

/// Motion of a handle that depends on time alone.
using HandlePath = std::function<HandleState(double t)>;

/// Returns the wrench of the virtual coupling on the hand, before any limit: the force is opposite to the
/// force on the tool, the moment is about the handle's origin.
Wrench coupling_on_hand(const ToolSpec& spec, const HandleState& tool, const HandleState& handle);

/// Terms of a tool as one block of the State, in closed form: inertia, gyroscopic moment with its tangent,
/// and weight, if any. Unlike those of Simbody (simbody_block.h) they allocate no memory in a step.
struct RigidTerms {
  std::shared_ptr<dynamics::InertiaTerm> inertia;
  std::vector<std::shared_ptr<dynamics::ForceTerm>> forces;
};

/// Builds these terms.
/// @param block_id  a rigid_block of the State
/// @param gravity   [m/s^2]; applies only if spec.gravity is set
/// @throws Error for invalid parameters, naming the key
RigidTerms make_rigid_terms(int block_id, const ToolSpec& spec, const Vec3& gravity);

/// Builds the force term of the virtual coupling of `spec` to a handle. With `symmetric`, the tangent keeps
/// only the symmetric part of the rotational stiffness (an inexact Newton matrix, exact if tool and handle
/// have the same orientation), for solvers that need symmetry; otherwise it is exact and unsymmetric.
std::shared_ptr<dynamics::ForceTerm> make_coupling_term(int block_id, const ToolSpec& spec, HandlePath handle,
                                                        bool symmetric = false);

}  // namespace palpate::tool
