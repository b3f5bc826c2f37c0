#pragma once
#include <optional>

#include "device/hand_model.h"
#include "model_reduction.h"
#include "palpate/device/limiter.h"
#include "palpate/device/motors.h"
#include "palpate/device/passivity.h"
#include "palpate/loop/world.h"
#include "palpate/scene/hands.h"
#include "palpate/tool/tool.h"
#include "proxy/proxy_set.h"
#include "rigid_contact_solver.h"
#include "tool/hand_block.h"

namespace palpate::loop {

/// State of a tool with ticks, as last communicated to the bodies.
struct ExchangedTool {
  double time = 0.0;  ///< [s]
  Pose pose;
  Twist twist;
};

/// One tool of a World: the tool, its hand, and its contact. All members are empty without [tool].
struct ToolInstance {
  std::string name;                         ///< Name in [[contact]]: "tool" for the first.
  const ToolSpec* spec = nullptr;           ///< Part of the World's description; null without [tool].
  const DeviceSpec* device_spec = nullptr;  ///< Part of the World's description; null without [tool].
  /// Tool with ticks; null for the monolithic scheme.
  std::unique_ptr<tool::Tool> tool;
  /// Second tool at the communicated state, for energies; null if not needed.
  std::unique_ptr<tool::Tool> energy_probe;
  /// Last communicated state. Bodies and observers may read only this: in real time the tool belongs to
  /// another thread.
  ExchangedTool exchanged;
  /// Monolithic scheme: block of the State; else -1.
  int block_id = -1;
  std::unique_ptr<device::Device> handle;
  /// Monolithic scheme with a simulated hand: its block of the State, instead of the device.
  struct HandInState {
    int block_id = -1;
    tool::HandBlock hand;
    device::HandModel model;
  };
  std::optional<HandInState> hand_in_state;
  device::HandleSample handle_now;  ///< At the last tick.
  std::unique_ptr<device::WrenchLimiter> limiter;
  /// Motors of the device; without delay for a hand in the State, which is not sampled.
  device::Motors motors;
  std::unique_ptr<device::PassivityController> passivity;  ///< null if passivity is off
  /// Frame of the tool in contact; null if no contact refers to the tool.
  std::shared_ptr<contact::MovingFrame> motion;
  /// Equals `motion` for the partitioned scheme, written by the ticks; else null.
  std::shared_ptr<contact::TrajectoryFrame> trajectory;
  std::shared_ptr<proxy::ProxySet> proxies;  ///< null without contact with a body with proxies
  int frame_index = -1;                      ///< Index of that frame in the contact, or -1.
  std::vector<contact::Tie> ties;            ///< Ties of the nodes that a tool with ticks carries.
  /// Contact of a tool with ticks with obstacles or other tools, shared by all tools that meet each other;
  /// else null.
  std::shared_ptr<RigidContactSolver> rigid;
  int number_in_rigid = -1;  ///< Index in `rigid`
  /// For linearisation = "points"; else null.
  std::unique_ptr<ModelReduction> touch;
  /// Factors the step matrix, for `condensed` and if `touch` cannot iterate; created on demand.
  std::unique_ptr<dynamics::LinearSolver> condenser;
  /// Created at the first step matrix without a Cholesky factor.
  std::unique_ptr<dynamics::LinearSolver> condenser_lu;
  dynamics::BorderedMatrix condensed_matrix;

  /// Creates one ToolInstance per hand of the World's description.
  static void make(World& world) {
    const std::vector<scene::Hand> hands = scene::hands_of(world.description);
    for (std::size_t i = 0; i < hands.size(); ++i) {
      if (i > 0) world.tool_sides_.push_back(std::make_unique<ToolInstance>());
      ToolInstance& side = *world.tool_sides_.back();
      side.name = hands[i].name;
      side.spec = hands[i].tool;
      side.device_spec = hands[i].device;
    }
  }
  /// Returns a new tool in its initial state.
  std::unique_ptr<tool::Tool> another_tool(const Vec3& gravity) const {
    return std::make_unique<tool::Tool>(*spec, spec->gravity ? gravity : Vec3(Vec3::Zero()));
  }

  /// Returns the ToolInstance of a hand; the first exists even if the scene has no tool.
  static ToolInstance& of(World& world, std::size_t hand = 0) { return *world.tool_sides_.at(hand); }
  static const ToolInstance& of(const World& world, std::size_t hand = 0) {
    return *world.tool_sides_.at(hand);
  }
  /// Returns the tool with that name in scenes; null if there is none.
  static ToolInstance* named(World& world, const std::string& name) {
    for (const auto& side : world.tool_sides_)
      if (side->spec && side->name == name) return side.get();
    return nullptr;
  }
  static const std::vector<std::unique_ptr<ToolInstance>>& all(const World& world) {
    return world.tool_sides_;
  }
};

}  // namespace palpate::loop
