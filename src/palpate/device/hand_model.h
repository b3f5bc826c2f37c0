#pragma once
#include <functional>

#include "palpate/device/arm_axis.h"
#include "palpate/device/device.h"

namespace palpate::device {

/// What [device] type = "hand" simulates: the equations stand in src/device/hand.cpp.
struct HandModel {
  ArmAxis::Parameters translation, rotation;     ///< of hand and device together, an axis each
  double arm_damping = 0.0;                      ///< the arm's part of it: about where it wants to be [N s/m]
  double arm_rotational_damping = 0.0;           ///< [N m s/rad]
  std::function<HandleSample(double t)> wanted;  ///< where the arm wants to be, and the switches
};
/// @throws Error for numbers that no hand can have, naming the key
HandModel hand_model(const DeviceSpec& spec);

}  // namespace palpate::device
