#pragma once
#include <optional>
#include <string>

#include "palpate/core/types.h"

namespace palpate::device {

/// Capabilities of a device, for people and programs; an empty value is not stated.
struct DeviceSpecification {
  std::string name;                            ///< Name for display.
  std::optional<double> max_force;             ///< Peak [N].
  std::optional<double> max_continuous_force;  ///< Without overheating [N].
  std::optional<double> max_torque;            ///< Peak [N m].
  std::optional<double> max_stiffness;         ///< Stiffest virtual wall, in the weakest direction [N/m].
  std::optional<double> max_damping;           ///< Largest damping of a virtual wall [N s/m].
  std::optional<Vec3> workspace;               ///< Extents along x, y, z [m].
  std::optional<double> rate;                  ///< Highest loop rate [1/s].
};

}  // namespace palpate::device
