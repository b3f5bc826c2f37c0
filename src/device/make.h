#pragma once
#include "palpate/device/device.h"

/// One factory per device type, each in a separate file.
namespace palpate::device {

/// Returns the value rounded to the nearest whole number of steps; unchanged if the step is 0.
inline Vec3 to_step(const Vec3& value, double step) {
  return step > 0.0 ? Vec3((value / step).array().round() * step) : value;
}

std::unique_ptr<Device> make_script(const DeviceSpec& spec, const std::string& folder);
std::unique_ptr<Device> make_hand(const DeviceSpec& spec, const std::string& folder);
std::unique_ptr<Device> make_recording(const DeviceSpec& spec, const std::string& folder);
std::unique_ptr<Device> make_udp(const DeviceSpec& spec, const std::string& folder);
std::unique_ptr<Device> make_plugin(const DeviceSpec& spec, const std::string& folder);
std::unique_ptr<Device> make_spacemouse(const DeviceSpec& spec, const std::string& folder);
std::unique_ptr<Device> make_gamepad(const DeviceSpec& spec, const std::string& folder);

}  // namespace palpate::device
