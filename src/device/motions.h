#pragma once
#include <functional>

#include "palpate/device/device.h"
#include "palpate/device/motions.h"

namespace palpate::device {

using DevicePath = std::function<HandleSample(double t)>;

/// Returns the sum of keyframes and motions of a spec, with its presses.  @throws Error for invalid
/// parameters
DevicePath path_of(const DeviceSpec& spec);

}  // namespace palpate::device
