#pragma once
#include <functional>

#include "device/arm_axis.h"
#include "palpate/device/device.h"

namespace palpate::device {

/// Parameters of the simulated hand, [device] type = "hand" (equations: src/device/hand.cpp).
struct HandModel {
  ArmAxis::Parameters translation, rotation;  ///< Hand and device together, per axis.
  double arm_damping = 0.0;                   ///< Damper of the arm, relative to the target motion [N s/m].
  double arm_rotational_damping = 0.0;        ///< Rotational damper of the arm [N m s/rad].
  std::function<HandleSample(double t)> requested;  ///< Target motion of the arm, and the switches.
};
/// Returns the parameters of a scene's hand.  @throws Error for invalid parameters, naming the key
HandModel hand_model(const DeviceSpec& spec);

}  // namespace palpate::device
