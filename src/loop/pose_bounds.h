#pragma once
#include "palpate/device/device.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

/// Returns the poses that a hand can have in this scene.
/// @param workspace  of its device
device::PoseBounds pose_bounds(const World& world, const device::Workspace& workspace);

}  // namespace palpate::loop
