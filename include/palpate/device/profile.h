#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/device/spec.h"
#include "palpate/device/specification.h"
#include "palpate/device/workspace.h"

namespace palpate::device {

class Device;

/// Published figures of one device, identified by `device.profile`.
struct DeviceProfile {
  std::string name, summary;                      ///< Name in a scene; one-line description.
  DeviceSpecification figures;                    ///< Figures stated by the maker.
  std::optional<double> mass = {};                ///< Apparent mass at the tip [kg].
  std::optional<double> friction = {};            ///< Backdrive friction [N].
  std::optional<double> encoder_resolution = {};  ///< Resolution at the tip [m].
};
/// Returns all profiles, in the order of `palpate list profiles`.
const std::vector<DeviceProfile>& device_profiles();

/// Effective parameters of a scene's device: keys of the scene take precedence, then its profile, then
/// defaults.
struct DeviceFigures {
  double max_force, max_torque;            ///< Maxima [N, N m].
  double max_force_slew, max_torque_slew;  ///< Slew rates [N/s, N m/s].
  double ramp;                             ///< Duration over which the force ramps in [s].
  Workspace workspace;                     ///< Region that the device can reach.
  double mass, damping, friction;          ///< Apparent, at the tip [kg, N s/m, N].
  double encoder_resolution;               ///< Resolution [m]; 0: exact.
  DeviceSpecification specification;       ///< For display and for programs.
};
/// Returns the effective parameters.  @throws Error for an unknown profile or a parameter out of range
DeviceFigures figures_of(const DeviceSpec& spec);
/// Returns the spec with the limits that the driver of the device reports, where the spec has neither a value
/// nor a profile.
DeviceSpec with_reported_limits(DeviceSpec spec, const Device& device);

}  // namespace palpate::device
