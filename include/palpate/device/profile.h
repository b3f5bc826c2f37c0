#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/device/spec.h"
#include "palpate/device/workspace.h"

namespace palpate::device {

/// What a device can do, for people and programs; empty: not stated.
struct DeviceSpecification {
  std::string name;                            ///< of the device, for people
  std::optional<double> max_force;             ///< peak [N]
  std::optional<double> max_continuous_force;  ///< without overheating [N]
  std::optional<double> max_torque;            ///< peak [N m]
  std::optional<double> max_stiffness;         ///< of a virtual wall, in its weakest direction [N/m]
  std::optional<double> max_damping;           ///< of a virtual wall [N s/m]
  std::optional<Vec3> workspace;               ///< extents along x, y, z [m]
  std::optional<double> rate;                  ///< of its loop, at most [1/s]
};

/// Published figures of one device, by the name that [device] profile gives it.
struct DeviceProfile {
  std::string name, summary;                      ///< as a scene names it; one line about it
  DeviceSpecification figures;                    ///< what its maker states
  std::optional<double> mass = {};                ///< apparent at the tip [kg]
  std::optional<double> friction = {};            ///< to drive it back [N]
  std::optional<double> encoder_resolution = {};  ///< of the tip [m]
};
/// All of them, in the order of `palpate list profiles`.
const std::vector<DeviceProfile>& device_profiles();

/// What a scene's device is in the end: keys of the scene first, then its profile, then the defaults.
struct DeviceFigures {
  double max_force, max_torque;            ///< [N, N m]
  double max_force_slew, max_torque_slew;  ///< [N/s, N m/s]
  double ramp;                             ///< over which the force sets in [s]
  Workspace workspace;                     ///< where it can be
  double mass, damping, friction;          ///< apparent, at the tip [kg, N s/m, N]
  double encoder_resolution;               ///< [m]; 0: none
  DeviceSpecification specification;       ///< for people and programs
};
/// @throws Error for a profile that is not known or a figure that is out of range
DeviceFigures figures_of(const DeviceSpec& spec);

}  // namespace palpate::device
