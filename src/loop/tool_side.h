#pragma once
#include "condenser.h"
#include "palpate/device/handle.h"
#include "palpate/device/limiter.h"
#include "palpate/loop/world.h"
#include "palpate/tool/tool.h"

namespace palpate::loop {

/// A World's tool: the tool itself, the hand's side of it, and its contact.  All empty without [tool].
struct ToolSide {
  /// the tool with ticks of its own; null where the scheme is monolithic
  std::unique_ptr<tool::Tool> tool;
  /// monolithic: its block of the State; else -1
  int block_id = -1;
  std::unique_ptr<device::Handle> handle;
  device::HandleSample handle_now;  ///< at the last tick
  std::unique_ptr<device::WrenchLimiter> limiter;
  /// the tool's frame in contact; null where no contact names the tool
  std::shared_ptr<contact::MovingFrame> motion;
  /// `motion` where the scheme is partitioned: written by the ticks; else null
  std::shared_ptr<contact::TrajectoryFrame> trajectory;
  std::shared_ptr<proxy::ProxySet> proxies;  ///< null where it meets no body with proxies
  int frame_index = -1;                      ///< of that frame in the contact, -1 where no contact names it
  bool meets_obstacles = false;              ///< a contact names the tool and an obstacle
  std::unique_ptr<Condenser> condenser;      ///< of the condensed linearisation; null where not used

  static ToolSide& of(World& world) { return *world.tool_side_; }
  static const ToolSide& of(const World& world) { return *world.tool_side_; }
};

}  // namespace palpate::loop
