#pragma once
#include "coupling.h"
#include "palpate/tool/tool.h"

namespace palpate::tool {

/// Everything that acts on the tool over one tick, a constant while the tick lasts.
struct TickInput {
  double t0 = 0.0, h = 0.0;  ///< [s]
  HandleMotion handle;
  dynamics::LinearisedContact contact;
  CouplingGains gains;
};

/// The handle at time t of the tick: cubic Hermite through poses and twists at both ends, its error O(h^4);
/// twist its exact derivative.
RigidMotion handle_at(const TickInput& input, double t);

/// Coupling and contact on the tool at time t (moment, force).
Vec6 applied_wrench(const TickInput& input, double t, const RigidMotion& tool);

/// A tick with the handle held at one of its ends: the input of fixed-tick schemes.
TickInput with_handle_held(const TickInput& input, const Pose& pose, const Twist& twist);

/// Whether one tick is a later repetition of the other: the handle stands still in both, at the same pose,
/// and contact and coupling are equal.
bool same_wrench(const TickInput& a, const TickInput& b);

bool is_finite(const RigidMotion& motion);
bool is_finite(const TickInput& input);

}  // namespace palpate::tool
