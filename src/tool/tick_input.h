#pragma once
#include "coupling.h"
#include "palpate/dynamics/linearised_contact.h"
#include "palpate/tool/tick.h"

namespace palpate::tool {

/// Inputs of the tool over one tick, constant during the tick.
struct TickInput {
  double t0 = 0.0, h = 0.0;  ///< [s]
  HandleMotion handle;
  dynamics::LinearisedContact contact;
  CouplingGains gains;
};

/// Returns the motion of the handle at time t of the tick: cubic Hermite interpolation of poses and twists at
/// both ends, error O(h^4). The twist is the exact derivative of the pose.
RigidMotion handle_at(const TickInput& input, double t);

/// Returns the wrench of coupling and contact on the tool at time t (moment, force).
Vec6 applied_wrench(const TickInput& input, double t, const RigidMotion& tool);

/// Returns the tick with the handle held at one pose and twist: the input of fixed-tick schemes.
TickInput with_handle_held(const TickInput& input, const Pose& pose, const Twist& twist);

/// Returns whether two ticks have equal wrenches for equal tool states: the handle is at rest at the same
/// pose in both, and contact and coupling are equal.
bool same_wrench(const TickInput& a, const TickInput& b);

bool is_finite(const RigidMotion& motion);
bool is_finite(const TickInput& input);

}  // namespace palpate::tool
