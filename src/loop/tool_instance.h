#pragma once
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "coupling/model_reduction.h"
#include "coupling/rigid_contact_solver.h"
#include "device/hand_model.h"
#include "palpate/contact/contact_force.h"
#include "palpate/device/limiter.h"
#include "palpate/device/motors.h"
#include "palpate/device/passivity.h"
#include "palpate/tool/tool.h"
#include "sampled_handle.h"
#include "tool/hand_block.h"

// Poses of a tool. Each is stored once:
//
//   ToolSpec::position_m          at the start of the simulation
//   PartitionedTool::tool.pose()  after the last tick, which only the thread of the ticks reads
//   PartitionedTool::path         at the ticks since the last exchange, as reported to the bodies; the last
//                                 one is World::tool_pose() and, until the next ticks, that of the next
//                                 exchange
//   MonolithicTool::block_id      in the State, at the State's time: World::tool_pose() of the monolithic
//                                 and the single-rate scheme
//   TickRecord::tool              at the end of one tick, in transit from the ticks to path and files
//   LinearisedContact::x0, ReducedContactModel::tool
//                                 pose of an exchange, in transit from the bodies to the ticks and files
//   TickGroup::motions_           at the start of the present tick, in transit to the RigidContactSolver
//   RigidContactSolver            at the start of the present tick, in the form that ContactForce reads
//   HapticLoop::past_             at the last ticks, for records that arrive late
//
// The handle has three: HapticLoop::handle_ (at the last tick) and HapticLoop::next_ (at the end of the
// present tick), both read by the ticks, and ToolInstance::handle (as reported to the bodies).
namespace palpate::loop {

/// Tool of the partitioned scheme, which advances by ticks. During a run `tool` and `rigid_contact` belong to
/// the ticks, in real time another thread; the bodies and observers may use only the other members.
struct PartitionedTool {
  tool::Tool tool;
  /// Its motion since the last exchange, and its frame in contact with bodies.
  std::shared_ptr<contact::TrajectoryFrame> path;
  std::vector<contact::Tie> ties = {};  ///< Ties of the nodes that it carries.
  /// Contact with obstacles and other tools, shared by all tools that meet each other; null if there is none.
  std::shared_ptr<RigidContactSolver> rigid_contact = {};
  int number_in_rigid_contact = -1;
  std::unique_ptr<ModelReduction> reduction = {};  ///< For linearisation = "points"; else null.
  StepFactor step_factor = {};                     ///< For linearisation = "condensed".
};

/// Tool of the monolithic and of the single-rate scheme: a block of the State.
struct MonolithicTool {
  /// Simulated hand that holds the device, as a block of the State.
  struct Hand {
    int block_id;
    tool::HandBlock block;
    device::HandModel model;
  };
  int block_id;
  /// Replaces the device where the scene simulates the hand; monolithic scheme only.
  std::optional<Hand> hand = {};
  /// Handle that the coupling follows; single-rate scheme only, else null.
  std::shared_ptr<SampledHandle> sampled = {};

  /// Returns the tool's pose and twist at a state.
  dynamics::RigidMotion motion(const dynamics::StateView& state) const {
    const dynamics::Block& block = *state.layout->find(block_id);
    const auto q = state.q.segment<7>(block.q_offset);
    const auto u = state.u.segment<6>(block.u_offset);
    return {{Quat(q[0], q[1], q[2], q[3]), q.tail<3>()}, {u.head<3>(), u.tail<3>()}};
  }
};

/// One tool of a World, and the device that moves it. During a run device, limiter, motors and passivity
/// controller belong to the ticks.
struct ToolInstance {
  std::string name;               ///< Name in [[contact]]: "tool" for the first.
  const ToolSpec& spec;           ///< Part of the World's description.
  const DeviceSpec& device_spec;  ///< Part of the World's description.
  std::unique_ptr<device::Device> device;
  device::WrenchLimiter limiter;
  std::variant<PartitionedTool, MonolithicTool> scheme;
  /// Motors of the device; without delay for the monolithic scheme, whose hand is not sampled.
  device::Motors motors = {};
  std::unique_ptr<device::PassivityController> passivity = {};  ///< null if passivity is off
  device::HandleSample handle = {};  ///< At the last tick that was reported to the bodies.
  int frame = -1;                    ///< Index of its frame in World::contact; -1 if no contact refers to it.

  PartitionedTool* partitioned() { return std::get_if<PartitionedTool>(&scheme); }
  const PartitionedTool* partitioned() const { return std::get_if<PartitionedTool>(&scheme); }
  const MonolithicTool* monolithic() const { return std::get_if<MonolithicTool>(&scheme); }
};

}  // namespace palpate::loop
