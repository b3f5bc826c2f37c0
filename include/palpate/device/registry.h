#pragma once
#include <memory>
#include <string>

#include "palpate/core/registry.h"
#include "palpate/device/device.h"

namespace palpate::device {

/// Factory of one device type. A device is one file in src/device and one entry in the registry, with the
/// keys of `[device]` that only this type uses; the keys that limit the force apply to all types.
/// @param folder  folder that relative paths in the spec refer to: the scene's
using MakeDevice = std::unique_ptr<Device> (*)(const DeviceSpec& spec, const std::string& folder);
/// Returns the device types by the name in `device.type`.
const Registry<MakeDevice>& device_registry();
/// Builds the device that the spec specifies.  @throws Error for an unknown type and invalid settings
std::unique_ptr<Device> make_device(const DeviceSpec& spec, const std::string& folder = {});

}  // namespace palpate::device
