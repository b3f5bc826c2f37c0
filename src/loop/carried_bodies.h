#pragma once
#include "tool_instance.h"

namespace palpate::loop {

/// Moves the bodies that a tool with ticks carries rigidly with it, over a time in which the bodies are held:
/// their positions and velocities relative to the tool do not change. If a body is held elsewhere, too, the
/// next step returns the held nodes.
/// @param before  pose of the tool at the State's time; its current pose is `side.known`
void carry_along(World& world, const ToolInstance& side, const Pose& before, const Twist& twist_before);

}  // namespace palpate::loop
