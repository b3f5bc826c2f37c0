#include "rigid_contact.h"

#include <algorithm>

#include "assemble_parts.h"
#include "contact_shapes.h"
#include "palpate/core/error.h"
#include "tool_instance.h"

namespace palpate::loop {

std::shared_ptr<contact::MovingFrame> frame_in_contact(World& world, ToolInstance& tool) {
  std::shared_ptr<contact::MovingFrame> frame;
  if (const PartitionedTool* partitioned = tool.partitioned())
    frame = partitioned->path;
  else
    frame = contact::block_frame(tool.monolithic()->block_id);
  if (tool.frame < 0) tool.frame = world.contact->add_frame(frame);
  return frame;
}

namespace {

/// Tool in a contact, with the frame of the ticks or of the World.
struct RigidSide {
  const ToolSpec& tool;
  int frame;
  std::shared_ptr<contact::MovingFrame> motion;
  double look_ahead;  ///< time to the next query [s]
  bool is_round() const { return tool.shape == ToolShape::kSphere; }
  contact::FrameSurface surface(const World& world) const {
    return {tool_surface(tool, world.folder), frame, motion};
  }
};

/// Returns contact of a tool with an exact shape.
/// @param source  returns the source of a given side on the shape
template <class Source>
std::unique_ptr<contact::SampleSource> rigid_on_shape(const World& world, const RigidSide& tool,
                                                      const ContactSpec& spec, const Shape& shape,
                                                      const Source& source) {
  const bool nearest_points = spec.method == "distance";
  if (tool.is_round())
    return source(
        contact::FrameBall{tool.tool.radius_m, Vec3::Zero(), tool.frame, tool.motion, nearest_points});
  const contact::FrameSurface surface = tool.surface(world);
  if (!nearest_points) return source(surface);
  try {
    const contact::CharacteristicLengths lengths = contact::lengths_of(surface.mesh);
    auto of_tool = source(contact::material_points(
        surface, contact::point_spacing(lengths, shape.lengths, spec.quadrature_error)));
    const auto own = own_points(shape, lengths, spec.quadrature_error);
    if (!own) return of_tool;
    return contact::make_half_and_half(
        std::move(of_tool),
        contact::make_distance_source(surface, *own, distance_options(spec, tool.look_ahead)));
  } catch (const Error& error) { refuse_distance(spec, error); }
}

/// @param force  receives the obstacle's frame
std::unique_ptr<contact::SampleSource> tool_on_obstacle(const World& world, const RigidSide& tool,
                                                        const ContactSpec& spec, const ObstacleSpec& obstacle,
                                                        contact::ContactForce& force) {
  if (tool.is_round() && spec.spring == "per_point")
    fail(
        "contact {} - {}: spring = \"per_point\" needs vertices, but a tool with shape = \"sphere\" has "
        "none; use \"per_area\"",
        spec.first, obstacle.name);
  const Shape shape = shape_of(force, obstacle);
  return rigid_on_shape(world, tool, spec, shape, [&](contact::ContactSide side) {
    return obstacle_source(shape, spec, std::move(side), spec.candidate_gap_m, tool.look_ahead, obstacle);
  });
}

/// Returns contact of two tools; a spherical tool is an exact shape.
std::unique_ptr<contact::SampleSource> tool_on_tool(const World& world, const RigidSide& a,
                                                    const RigidSide& b, const ContactSpec& spec) {
  if (spec.method != "distance")
    fail(
        "contact {} - {}: contact between two tools needs method = \"distance\" (nearest points); use method "
        "= \"auto\"",
        spec.first, spec.second);
  if (b.is_round())
    return rigid_on_shape(
        world, a, spec, round_tool(b.tool.radius_m, b.frame, b.motion), [&](contact::ContactSide side) {
          return contact::make_sphere_source(std::move(side), b.frame, b.motion, Vec3::Zero(),
                                             b.tool.radius_m, spec.candidate_gap_m, b.look_ahead);
        });
  if (a.is_round()) return tool_on_tool(world, b, a, spec);
  try {
    return contact::make_distance_source(a.surface(world), b.surface(world),
                                         distance_options(spec, a.look_ahead));
  } catch (const Error& error) { refuse_distance(spec, error); }
}

/// Builds one contact twice: for the ticks, which keep it, and for the World, which is returned.
/// @param make  make(tools in order, contact)
template <class Make>
std::unique_ptr<contact::SampleSource> make_for_ticks_and_world(World& world,
                                                                const std::vector<ToolInstance*>& meeting,
                                                                const ContactSpec& spec, const Make& make) {
  std::vector<RigidSide> in_ticks, in_world;
  const scene::CosimulationSpec& exchange = world.description.exchange;
  for (ToolInstance* tool : meeting) {
    const auto motion = frame_in_contact(world, *tool);
    const PartitionedTool* partitioned = tool->partitioned();
    const double look_ahead = partitioned ? exchange.exchange_period_s : exchange.contact_refresh_s;
    in_world.push_back({tool->spec, tool->frame, motion, look_ahead});
    if (!partitioned) continue;
    const RigidContactSolver& solver = *partitioned->rigid_contact;
    const int number = partitioned->number_in_rigid_contact;
    in_ticks.push_back({tool->spec, solver.frame(number), solver.motion(number), solver.look_ahead()});
  }
  if (!in_ticks.empty()) {
    contact::ContactForce& own = meeting.front()->partitioned()->rigid_contact->contact();
    own.add_pair(make(in_ticks, own), spec);
  }
  return make(in_world, *world.contact);
}

const ObstacleSpec* obstacle_named(const World& world, const std::string& name) {
  const auto& all = world.description.obstacles;
  const auto at = std::find_if(all.begin(), all.end(), [&](const ObstacleSpec& o) { return o.name == name; });
  return at == all.end() ? nullptr : &*at;
}

}  // namespace

std::unique_ptr<contact::SampleSource> rigid_source(World& world, const ContactSpec& spec) {
  ToolInstance* const first = world.find_tool(spec.first);
  ToolInstance* const second = world.find_tool(spec.second);
  const ObstacleSpec* const obstacle = obstacle_named(world, spec.second);
  if (first && obstacle)
    return make_for_ticks_and_world(world, {first}, spec,
                                    [&](const std::vector<RigidSide>& tools, contact::ContactForce& force) {
                                      return tool_on_obstacle(world, tools[0], spec, *obstacle, force);
                                    });
  if (!first || !second || first == second) return {};
  return make_for_ticks_and_world(world, {first, second}, spec,
                                  [&](const std::vector<RigidSide>& tools, contact::ContactForce&) {
                                    return tool_on_tool(world, tools[0], tools[1], spec);
                                  });
}

void make_rigid_contact_solver(World& world) {
  const scene::Description& d = world.description;
  if (world.monolithic()) return;
  const std::vector<std::size_t> first = scene::connected_tools(d);
  for (std::size_t i = 0; i < first.size(); ++i) {
    ToolInstance& tool = world.tools[i];
    const bool meets = std::any_of(d.contacts.begin(), d.contacts.end(), [&](const ContactSpec& contact) {
      const auto with = [&](const std::string& name) {
        return obstacle_named(world, name) || world.find_tool(name);
      };
      return (contact.first == tool.name && with(contact.second)) ||
             (contact.second == tool.name && with(contact.first));
    });
    if (!meets) continue;
    const ToolInstance& leader = world.tools[first[i]];
    if (tool.spec.tick_s != leader.spec.tick_s)
      at_place(world, scene::hands_of(d)[i].tool_key + ".tick_s", "", [&] {
        fail(
            "tools that can touch each other must have the same ticks, but the tool of \"{}\" has tick_s = "
            "{}, that of \"{}\" {}; make them equal",
            tool.name, tool.spec.tick_s, leader.name, leader.spec.tick_s);
      });
    PartitionedTool& partitioned = *tool.partitioned();
    partitioned.rigid_contact = leader.partitioned()->rigid_contact;
    if (!partitioned.rigid_contact)
      partitioned.rigid_contact =
          std::make_shared<RigidContactSolver>(std::max(d.exchange.contact_refresh_s, tool.spec.tick_s));
    partitioned.number_in_rigid_contact = partitioned.rigid_contact->add(tool.spec);
  }
}

}  // namespace palpate::loop
