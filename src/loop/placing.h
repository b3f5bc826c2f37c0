#pragma once
#include "palpate/loop/world.h"

namespace palpate::loop {

/// Largest gap at which a placed tool counts as touching [m].
inline constexpr double kTouchingGap = 1e-6;

/// Moves each tool with start = "touching" from its position_m along its start_direction until it touches an
/// object of its contacts: until the exact gap (loop/clearance.h) is at most kTouchingGap, and positive. The
/// tool moves in steps of the current gap. The gap changes by no more than the displacement, so that no step
/// passes the first touch. The keyframes of the device are moved by the same vector: they keep their distance
/// from the tool. The description of the World is changed, and World::placements set.
/// @pre bodies are assembled, tools are not
/// @throws Error where the tool starts inside an object or misses all of them, or where the device repeats a
///   recording or the tool carries nodes, which would not move with it
void place_tools(World& world);

}  // namespace palpate::loop
