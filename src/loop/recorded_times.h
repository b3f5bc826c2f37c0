#pragma once
#include "palpate/device/device.h"

namespace palpate::loop {

/// Rejects a recording whose times do not match a scene of length `duration_s`: entirely before or after it,
/// or in another unit. @throws Error with both ranges, and the keys that shift and scale them
void check_recorded_times(const device::Device& handle, const DeviceSpec& spec, double duration_s);

}  // namespace palpate::loop
