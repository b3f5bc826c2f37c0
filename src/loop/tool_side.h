#pragma once
#include <optional>

#include "palpate/device/hand_model.h"
#include "palpate/device/limiter.h"
#include "palpate/device/motors.h"
#include "palpate/device/passivity.h"
#include "palpate/loop/world.h"
#include "palpate/proxy/proxy_set.h"
#include "palpate/scene/hands.h"
#include "palpate/tool/hand_block.h"
#include "palpate/tool/tool.h"
#include "rigid_touch.h"
#include "touch_reduction.h"

namespace palpate::loop {

/// A tool with ticks of its own, as the bodies last heard of it.
struct KnownTool {
  double time = 0.0;  ///< [s]
  Pose pose;
  Twist twist;
};

/// One of a World's tools: the tool itself, the hand's side of it, and its contact.  All empty without
/// [tool].
struct ToolSide {
  std::string name;                         ///< what [[contact]] calls it: "tool" is the first
  const ToolSpec* spec = nullptr;           ///< in the World's description; null without [tool]
  const DeviceSpec* device_spec = nullptr;  ///< the same
  /// the tool with ticks of its own; null where the scheme is monolithic
  std::unique_ptr<tool::Tool> tool;
  /// one more, where the tool is, for energies; null where nobody asked
  std::unique_ptr<tool::Tool> as_known;
  /// all that bodies and observers may read of it: in real time the tool belongs to another thread
  KnownTool known;
  /// monolithic: its block of the State; else -1
  int block_id = -1;
  std::unique_ptr<device::Device> handle;
  /// monolithic, of a simulated hand: its block of the State, in the device's place
  struct HandInState {
    int block_id = -1;
    tool::HandBlock hand;
    device::HandModel model;
  };
  std::optional<HandInState> hand_in_state;
  device::HandleSample handle_now;  ///< at the last tick
  std::unique_ptr<device::WrenchLimiter> limiter;
  device::Motors motors;  ///< of the device; of a hand in the State, which has no ticks, without delay
  std::unique_ptr<device::PassivityController> passivity;  ///< null where it is off
  /// the tool's frame in contact; null where no contact names the tool
  std::shared_ptr<contact::MovingFrame> motion;
  /// `motion` where the scheme is partitioned: written by the ticks; else null
  std::shared_ptr<contact::TrajectoryFrame> trajectory;
  std::shared_ptr<proxy::ProxySet> proxies;  ///< null where it meets no body with proxies
  int frame_index = -1;                      ///< of that frame in the contact, -1 where no contact names it
  std::vector<contact::Tie> ties;            ///< of the nodes that a tool of ticks carries
  /// of a tool of ticks that meets obstacles or other tools, shared by all tools that meet each other; else
  /// null
  std::shared_ptr<RigidTouch> rigid;
  int number_in_rigid = -1;  ///< there
  /// of linearisation = "points"; else null
  std::unique_ptr<TouchReduction> touch;
  /// factors the step matrix, for `condensed` and where `touch` cannot iterate; null until then
  std::unique_ptr<dynamics::LinearSolver> condenser;
  /// made at the first step matrix without a Cholesky factor
  std::unique_ptr<dynamics::LinearSolver> condenser_lu;
  dynamics::BorderedMatrix condensed_matrix;

  /// One for each hand of the World's description.
  static void make(World& world) {
    const std::vector<scene::Hand> hands = scene::hands_of(world.description);
    for (std::size_t i = 0; i < hands.size(); ++i) {
      if (i > 0) world.tool_sides_.push_back(std::make_unique<ToolSide>());
      ToolSide& side = *world.tool_sides_.back();
      side.name = hands[i].name;
      side.spec = hands[i].tool;
      side.device_spec = hands[i].device;
    }
  }
  /// A tool as the scene begins with.
  std::unique_ptr<tool::Tool> another_tool(const Vec3& gravity) const {
    return std::make_unique<tool::Tool>(*spec, spec->gravity ? gravity : Vec3(Vec3::Zero()));
  }

  /// The first is there even where the scene has no tool.
  static ToolSide& of(World& world, std::size_t hand = 0) { return *world.tool_sides_.at(hand); }
  static const ToolSide& of(const World& world, std::size_t hand = 0) { return *world.tool_sides_.at(hand); }
  /// The tool that scenes call so; null where there is none.
  static ToolSide* named(World& world, const std::string& name) {
    for (const auto& side : world.tool_sides_)
      if (side->spec && side->name == name) return side.get();
    return nullptr;
  }
  static const std::vector<std::unique_ptr<ToolSide>>& all(const World& world) { return world.tool_sides_; }
};

}  // namespace palpate::loop
