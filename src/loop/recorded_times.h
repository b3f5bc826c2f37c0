#pragma once
#include "palpate/device/device.h"

namespace palpate::loop {

/// Refuses a recording whose times are not those of a scene that lasts `duration_s`: all before it or behind
/// it, or so many that their unit is another one.  @throws Error with both ranges, and the keys that shift
/// and scale them
void check_recorded_times(const device::Device& handle, const DeviceSpec& spec, double duration_s);

}  // namespace palpate::loop
