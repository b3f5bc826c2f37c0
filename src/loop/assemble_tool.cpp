#include <Eigen/Eigenvalues>
#include <algorithm>
#include <filesystem>

#include "assemble_parts.h"
#include "loop/replay.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "palpate/core/named_enum.h"
#include "palpate/device/profile.h"
#include "palpate/device/registry.h"
#include "palpate/integrate/integrators.h"
#include "palpate/tool/tool.h"
#include "pose_bounds.h"
#include "recorded_times.h"
#include "store/model_file.h"
#include "tool/simbody_block.h"
#include "tool_instance.h"

namespace palpate::loop {

namespace {

/// Returns the handle's motion as a function of time. A monolithic integrator requires it, because it
/// evaluates the motion at times before and after the tick.
tool::HandlePath path_of(const device::Device& handle, const DeviceSpec& spec) {
  auto path = handle.path();
  if (!path)
    fail(
        "exchange: scheme = \"monolithic\" needs a handle with a prescribed path, which [device] type = "
        "\"{}\" does not have; use scheme = \"partitioned\"",
        spec.type);
  return [path = std::move(path)](double t) {
    const device::HandleSample s = path(t);
    return tool::HandleState{s.pose, s.twist};
  };
}

tool::HandBlock hand_of(const device::HandModel& model) {
  const auto axis = [](const device::ArmAxis::Parameters& p, double arm_damping) {
    return tool::HandBlock::Axis{p.mass, p.stiffness, arm_damping, p.damping - arm_damping, p.friction};
  };
  return {axis(model.translation, model.arm_damping), axis(model.rotation, model.arm_rotational_damping),
          [requested = model.requested](double t) {
            const device::HandleSample s = requested(t);
            return tool::HandleState{s.pose, s.twist};
          }};
}

/// Adds the hand to the State, as one block coupled to the tool.
MonolithicTool::Hand assemble_hand(World& world, const scene::Hand& hand, int tool_block,
                                   const dynamics::BlockSpec& tool_spec) {
  const scene::Description& d = world.description;
  if (d.record && d.record->energy)
    fail(
        "exchange: scheme = \"monolithic\" with a simulated hand: record.energy = true records the work of "
        "an external hand, but a simulated hand is part of the system; set it to false");
  MonolithicTool::Hand out;
  out.model = device::hand_model(*hand.device);
  out.block = hand_of(out.model);
  out.block_id = world.state.insert(tool::hand_block(tool_spec.q_scale, tool_spec.u_scale),
                                    tool::hand_at_start(out.block), VecX::Zero(6));
  const tool::HandTerms terms = tool::make_hand_terms(out.block_id, tool_block, *hand.tool, out.block);
  world.system.add(terms.inertia);
  world.system.add(terms.arm);
  world.system.add(terms.coupling);
  return out;
}

/// Adds the tool to the State, as one block coupled to the bodies.
/// @param own_device  whether the device is the scene's, not a replacement
MonolithicTool assemble_block(World& world, const scene::Hand& hand, const device::Device& device,
                              bool own_device) {
  const ToolSpec& spec = *hand.tool;
  if (spec.tick_s != world.description.tool->tick_s)
    fail(
        "exchange: scheme = \"{}\" samples all tools at the same ticks, but hand \"{}\" has tick_s = {}, the "
        "first hand {}; make them equal",
        name_of(world.description.exchange.scheme), hand.name, spec.tick_s, world.description.tool->tick_s);
  const Quat r = quaternion_of(spec.rotation_vector_rad);
  VecX q(7);
  q << r.w(), r.vec(), spec.position_m;
  const dynamics::BlockSpec tool_spec = tool::tool_block(spec);
  MonolithicTool out{.block_id = world.state.insert(tool_spec, q, VecX::Zero(6))};
  if (world.description.exchange.scheme == scene::ExchangeScheme::kSingleRate) {
    const tool::RigidTerms terms = tool::make_rigid_terms(out.block_id, spec, world.description.gravity_m_s2);
    world.system.add(terms.inertia);
    for (const auto& force : terms.forces) world.system.add(force);
    out.sampled = std::make_shared<SampledHandle>();
    world.system.add(tool::make_coupling_term(out.block_id, spec,
                                              [handle = out.sampled](double t) { return handle->at(t); }));
    return out;
  }
  const tool::SimbodyTerms terms =
      tool::make_simbody_terms(out.block_id, spec, world.description.gravity_m_s2);
  world.system.add(terms.inertia);
  world.system.add(terms.force);
  if (own_device && hand.device->type == "hand")
    out.hand = assemble_hand(world, hand, out.block_id, tool_spec);
  else
    world.system.add(tool::make_coupling_term(out.block_id, spec, path_of(device, *hand.device)));
  return out;
}

/// Returns the hand's [device] in the World's description.
DeviceSpec& device_spec_of(scene::Description& d, const scene::Hand& hand) {
  for (scene::HandSpec& other : d.hands)
    if (&other.device == hand.device) return other.device;
  PALPATE_CHECK(d.device && &*d.device == hand.device, "\"{}\" is of another description", hand.name);
  return *d.device;
}

/// Returns the spec with the pose of the tool where it has no pose for the start.
DeviceSpec started_at_tool(DeviceSpec spec, const ToolSpec& tool) {
  if (!spec.start_position_m) spec.start_position_m = tool.position_m;
  if (!spec.start_rotation_vector_rad) spec.start_rotation_vector_rad = tool.rotation_vector_rad;
  return spec;
}

/// Builds the device. A recording in HDF5 is the record of another run's hand, which `device` cannot read.
std::unique_ptr<device::Device> own_device_of(const DeviceSpec& spec, const std::string& folder) {
  const std::filesystem::path file(spec.file);
  if (spec.type != "recording" || file.extension() != ".h5") return device::make_device(spec, folder);
  HapticRecord record = read_haptic_record((std::filesystem::path(folder) / file).string());
  set_clock(record, device::RecordingClock::of(spec));
  return recorded_hand(std::move(record));
}

/// Warns if semi-implicit Euler diverges in the coupling alone, beyond k = 4 m/h^2 - 2 b/h
/// (tool/fixed_tick.cpp), in translation or about the axis of the smallest moment of inertia.
void warn_of_limit(const scene::Hand& hand, const tool::Tool& tool) {
  const ToolSpec& spec = *hand.tool;
  if (spec.integrator != "semi-implicit-euler") return;
  const Mat6 M = tool.mass_matrix();
  const double h = spec.tick_s,
               inertia =
                   Eigen::SelfAdjointEigenSolver<Mat3>(M.topLeftCorner<3, 3>()).eigenvalues().minCoeff();
  const auto warn = [&](const char* what, const char* unit, double stiffness, double damping, double mass) {
    const double most = 4.0 * mass / (h * h) - 2.0 * damping / h;
    if (stiffness < most) return;
    log::warn(
        "{}: semi-implicit-euler diverges with ticks of {:g} s: {} = {:g} {} is not below its stability "
        "limit of {:g} {}; use tool.integrator = \"linearly-implicit-euler\", which has none",
        hand.name, h, what, stiffness, unit, std::max(0.0, most), unit);
  };
  const auto& c = spec.coupling;
  warn("coupling.stiffness_n_m", "N/m", c.stiffness_n_m, c.damping_n_s_m, spec.mass_kg);
  warn("coupling.rotational_stiffness_n_m_rad", "N m/rad", c.rotational_stiffness_n_m_rad,
       c.rotational_damping_n_m_s_rad, inertia);
}

}  // namespace

ToolInstance assemble_tool(World& world, const scene::Hand& hand, std::unique_ptr<device::Device> device) {
  const scene::Description& d = world.description;
  DeviceSpec& spec = device_spec_of(world.description, hand);
  const bool own_device = !device;
  if (own_device) {
    device = own_device_of(started_at_tool(spec, *hand.tool), world.folder);
    check_recorded_times(*device, spec, d.duration_s);
    spec = device::with_reported_limits(spec, *device);
  }
  const device::DeviceFigures figures = device::figures_of(spec);
  device::WrenchLimiter limiter(figures.max_force, figures.max_torque, figures.ramp, figures.max_force_slew,
                                figures.max_torque_slew);
  limiter.confine(figures.workspace, *device);
  // The monolithic scheme knows the handle's path in advance, and its hand is not sampled.
  const bool sampled = d.exchange.scheme != scene::ExchangeScheme::kMonolithic;
  device::Motors motors = sampled ? device::Motors(device::motor_figures(spec)) : device::Motors();
  device->start_at({quaternion_of(hand.tool->rotation_vector_rad), hand.tool->position_m});
  device->bound(pose_bounds(world, figures.workspace));
  const auto instance = [&](auto scheme) {
    return ToolInstance{.name = hand.name,
                        .spec = *hand.tool,
                        .device_spec = spec,
                        .device = std::move(device),
                        .limiter = limiter,
                        .scheme = std::move(scheme),
                        .motors = std::move(motors)};
  };
  if (d.exchange.has_tools_in_state()) return instance(assemble_block(world, hand, *device, own_device));
  tool::Tool tool(*hand.tool, d.gravity_m_s2);
  warn_of_limit(hand, tool);
  auto path = std::make_shared<contact::TrajectoryFrame>();
  path->append(tool.time(), tool.pose(), tool.twist());
  return instance(PartitionedTool{.tool = std::move(tool), .path = std::move(path)});
}

TriMesh tool_surface(const ToolSpec& spec, const std::string& folder) {
  if (spec.shape == ToolShape::kMesh && spec.mesh.has_model()) {
    const std::string path = (std::filesystem::path(folder) / spec.mesh.file).string();
    TriMesh skin = store::read_model(path).model.skin;
    if (skin.faces.cols() == 0)
      fail("tool: mesh: {} has no skin; `palpate model` writes files with a skin", path);
    skin.vertices *= spec.mesh.factor();
    return skin;
  }
  if (spec.shape == ToolShape::kMesh) return mesh::surface(spec.mesh, folder);
  MeshSpec ball;
  ball.generator = "ball";
  ball.radius_m = spec.radius_m;
  ball.element_size_m = spec.radius_m / 8.0;
  return mesh::surface(ball, folder);
}

}  // namespace palpate::loop
