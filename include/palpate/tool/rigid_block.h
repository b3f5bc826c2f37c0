#pragma once
#include <functional>
#include <memory>

#include "palpate/core/pose.h"
#include "palpate/dynamics/force_term.h"
#include "palpate/dynamics/inertia_term.h"
#include "palpate/tool/spec.h"

/// A free rigid body as a block of the State: what couples a tool monolithically to soft bodies, with any integrator of theirs.  No Simbody here: see simbody_block.h for the same from Simbody.
/// q = (qw qx qy qz px py pz), u = (angular, linear) in world axes; the origin is the centre of mass, the body axes are principal.
namespace palpate::tool {

/// The block of that body; `length` [m] and `speed` [m/s] are the sizes that matter to error control (an angle counts as length/`length`).
dynamics::BlockSpec rigid_block(std::string name, double length, double speed);

/// M = diag(R I R^T, m): turns with the body.  @param inertia principal moments [kg m^2]  @throws Error for moments that are no body's
std::shared_ptr<dynamics::InertiaTerm> make_rigid_inertia(int block_id, double mass, const Vec3& inertia);

/// -omega x (R I R^T omega).  Its tangent is unsymmetric and usually small against the rest: left out, and the term symmetric, unless asked for.
std::shared_ptr<dynamics::ForceTerm> make_gyroscopic(int block_id, const Vec3& inertia, bool tangent = false);

/// m g at the centre of mass.
std::shared_ptr<dynamics::ForceTerm> make_rigid_weight(int block_id, double mass, const Vec3& gravity);

/// A handle as a function of time alone.
struct HandleState { Pose pose; Twist twist; };
using HandlePath = std::function<HandleState(double t)>;

/// What the hand feels of the virtual coupling, before any limit: force opposite to that on the tool, moment about the handle's origin.
Wrench coupling_on_hand(const ToolSpec& spec, const HandleState& tool, const HandleState& handle);

/// The virtual coupling of `spec` to a handle.  `symmetric` keeps the symmetric part of the rotational stiffness (an inexact Newton matrix,
/// exact where tool and handle have the same orientation) for solvers that need it; else the tangent is exact and unsymmetric.
std::shared_ptr<dynamics::ForceTerm> make_coupling_term(int block_id, const ToolSpec& spec, HandlePath handle, bool symmetric = false);

}  // namespace palpate::tool
