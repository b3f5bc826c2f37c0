#pragma once
#include "palpate/device/device.h"
#include "palpate/device/workspace.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

/// Returns bounds on the poses and speeds of a hand in this scene.
/// @param workspace  workspace of its device
device::PoseBounds pose_bounds(const World& world, const device::Workspace& workspace);

}  // namespace palpate::loop
