#include "palpate/loop/haptic_memory.h"

#include "tool_side.h"

namespace palpate::loop {

void HapticMemory::period(World& world, double t) {
  if (t > 0.0 || !ToolSide::of(world).handle) return;
  const device::HandleSample& handle = ToolSide::of(world).handle_now;
  record_.start.handle = handle.pose;
  record_.start.handle_twist = handle.twist;
  record_.start.handle_valid = handle.valid;
}

}  // namespace palpate::loop
