#pragma once
#include "palpate/device/device.h"

/// One function a device, each in a file of its own.
namespace palpate::device {

/// @throws Error `device: KEY = VALUE ...` for a value out of its range
void check_range(const char* key, double value, const Range& range);

std::unique_ptr<Device> make_script(const DeviceSpec& spec, const std::string& folder);
std::unique_ptr<Device> make_hand(const DeviceSpec& spec, const std::string& folder);
std::unique_ptr<Device> make_recording(const DeviceSpec& spec, const std::string& folder);
std::unique_ptr<Device> make_udp(const DeviceSpec& spec, const std::string& folder);

}  // namespace palpate::device
