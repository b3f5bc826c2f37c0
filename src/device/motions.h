#pragma once
#include <functional>

#include "palpate/device/device.h"
#include "palpate/device/motions.h"

namespace palpate::device {

using DevicePath = std::function<HandleSample(double t)>;

/// Keyframes, motions and presses of a spec together.  @throws Error for those that are no path
DevicePath path_of(const DeviceSpec& spec);

}  // namespace palpate::device
