#pragma once
#include "tool_side.h"

namespace palpate::loop {

/// Takes the bodies that a tool of ticks carries along with it, rigidly, over a time that they stand still
/// in: as they lie in the tool and move against it, they do afterwards.  Of a body that is held elsewhere,
/// too, the held nodes go back with the next step.
/// @param before  the tool when the State was last its own; it is at `side.known` now
void carry_along(World& world, const ToolSide& side, const Pose& before, const Twist& twist_before);

}  // namespace palpate::loop
