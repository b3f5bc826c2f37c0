#pragma once
#include <pybind11/numpy.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/device/device.h"
#include "palpate/scene/description.h"

namespace palpate::python {

/// Pose of a handle as a Python function returns it. Velocities that are missing are computed from the
/// previous tick.
struct HandlePose {
  Pose pose;
  std::optional<Vec3> velocity, angular_velocity;  ///< [m/s, rad/s]
  std::uint32_t switches = 0;
  bool valid = true;
};

/// Returns one device per hand of the scene, in the numbering of scene::hands_of(): a device that calls the
/// Python function given for that hand, or null for the scene's.
/// @param hands  None, one function for the first hand, or a dict of names and functions
/// @throws Error for an unknown hand, and for a scene whose scheme needs the path in advance
std::vector<std::unique_ptr<device::Device>> callback_devices(const pybind11::object& hands,
                                                              const scene::Description& description);

}  // namespace palpate::python
