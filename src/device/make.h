#pragma once
#include "palpate/device/handle.h"

/// One function a device, each in a file of its own.
namespace palpate::device {

std::unique_ptr<Handle> make_script(const DeviceSpec& spec);

}  // namespace palpate::device
