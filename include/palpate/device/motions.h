#pragma once
#include "palpate/core/registry.h"
#include "palpate/device/spec.h"

namespace palpate::device {

/// Displacement of a motion and its first two derivatives by time [m, m/s, m/s^2].
struct Displacement {
  Vec3 x = Vec3::Zero(), v = Vec3::Zero(), a = Vec3::Zero();  ///< displacement, velocity and acceleration
};

/// One kind of [[device.motion]].  @param s  time since it began [s]
using MakeMotion = Displacement (*)(const MotionSpec& spec, double s);
/// Kinds by the name in `device.motion.kind`.
const Registry<MakeMotion>& motion_registry();

/// Zero before its start; after its end it rests at its last displacement.
Displacement displacement(const MotionSpec& spec, double t);
/// @throws Error beginning with `where`
void check_motion(const MotionSpec& spec, const std::string& where);

}  // namespace palpate::device
