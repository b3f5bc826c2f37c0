#include "loop/haptic_memory.h"

#include "tool_instance.h"

namespace palpate::loop {

void HapticMemory::period(World& world, double t) {
  if (t > 0.0) return;
  records_.clear();
  for (const ToolInstance& tool : world.tools) {
    const device::HandleSample& handle = tool.handle;
    TickRecord& start = records_.emplace_back().start;
    start.handle = handle.pose;
    start.handle_twist = handle.twist;
    start.handle_valid = handle.valid;
    start.switches = handle.switches;
  }
}

}  // namespace palpate::loop
