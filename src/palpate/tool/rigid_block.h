#pragma once
#include <functional>
#include <memory>

#include "palpate/core/pose.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/tool/spec.h"

/// A tool as a rigid block of the State: it couples monolithically to soft bodies, under any of their
/// integrators.  No Simbody here: simbody_block.h has such a block by Simbody.
namespace palpate::tool {

using dynamics::make_gyroscopic;
using dynamics::make_rigid_inertia;
using dynamics::make_rigid_weight;
using dynamics::rigid_block;

/// A handle as a function of time alone.
struct HandleState {
  Pose pose;
  Twist twist;
};
using HandlePath = std::function<HandleState(double t)>;

/// Wrench of the virtual coupling on the hand, before any limit: force opposite to that on the tool, moment
/// about the handle's origin.
Wrench coupling_on_hand(const ToolSpec& spec, const HandleState& tool, const HandleState& handle);

/// The virtual coupling of `spec` to a handle.  `symmetric` keeps the symmetric part of the rotational
/// stiffness (an inexact Newton matrix, exact where tool and handle have the same orientation) for solvers
/// that need it; else the tangent is exact and unsymmetric.
std::shared_ptr<dynamics::ForceTerm> make_coupling_term(int block_id, const ToolSpec& spec, HandlePath handle,
                                                        bool symmetric = false);

}  // namespace palpate::tool
