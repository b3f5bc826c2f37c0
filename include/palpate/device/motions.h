#pragma once
#include "palpate/core/registry.h"
#include "palpate/device/spec.h"

namespace palpate::device {

/// Displacement of a motion and its first two time derivatives [m, m/s, m/s^2].
struct Displacement {
  Vec3 x = Vec3::Zero(), v = Vec3::Zero(), a = Vec3::Zero();  ///< Displacement, velocity, acceleration.
};

/// Function that evaluates one kind of [[device.motion]].  @param s  time since its start [s]
using MakeMotion = Displacement (*)(const MotionSpec& spec, double s);
/// Returns the kinds by the name in `device.motion.kind`.
const Registry<MakeMotion>& motion_registry();

/// Evaluates a motion at time t [s]: zero before its start, at rest at the last displacement after its end.
Displacement displacement(const MotionSpec& spec, double t);
/// Checks the parameters of a motion.  @throws Error beginning with `where`
void check_motion(const MotionSpec& spec, const std::string& where);

}  // namespace palpate::device
