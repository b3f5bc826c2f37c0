#include <algorithm>
#include <cmath>
#include <map>

#include "assemble_parts.h"
#include "bones/shape.h"
#include "palpate/core/error.h"
#include "palpate/device/keyframes.h"
#include "palpate/dynamics/rigid_body.h"
#include "tool_instance.h"

namespace palpate::loop {
namespace {

const BoneSpec* spec_of(const World& world, const std::string& bone) {
  for (const BoneSpec& spec : world.description.bones)
    if (spec.name == bone) return &spec;
  return nullptr;
}

std::vector<int> nodes_in_region(const World& world, const Body& body, const AttachmentSpec& spec) {
  if (spec.region == Selection::kBox) return fem::nodes_in_box(body.placed, spec.box_min_m, spec.box_max_m);
  if (spec.region == Selection::kSphere)
    return fem::nodes_in_sphere(body.placed, spec.centre_m, spec.radius_m);
  const BoneSpec* bone = spec_of(world, spec.to);
  if (!bone) {
    const ToolSpec& tool = *scene::tool_named(world.description, spec.to);
    return fem::nodes_in_sphere(body.placed, tool.position_m, tool.radius_m);
  }
  const Pose from_world = Pose{quaternion_of(bone->rotation_vector_rad), bone->position_m}.inverse();
  std::vector<int> out;
  for (int i = 0; i < body.placed.cols(); ++i)
    if (bones::inside_bone(*bone, from_world * Vec3(body.placed.col(i)))) out.push_back(i);
  return out;
}

/// Returns the nodes that an attachment holds: of a divided mesh, the nodes of the mesh before its division
/// that lie in the region, and the midpoints of edges whose ends are held.
std::vector<int> nodes_inside(const World& world, const Body& body, const AttachmentSpec& spec) {
  std::vector<int> inside = nodes_in_region(world, body, spec);
  if (body.midpoints.empty()) return inside;
  std::vector<char> held(static_cast<std::size_t>(body.placed.cols()), 0);
  for (const int node : inside) held[static_cast<std::size_t>(node)] = 1;
  for (const Midpoint& m : body.midpoints)
    held[static_cast<std::size_t>(m.node)] =
        static_cast<char>(held[static_cast<std::size_t>(m.a)] && held[static_cast<std::size_t>(m.b)]);
  inside.clear();
  for (std::size_t i = 0; i < held.size(); ++i)
    if (held[i]) inside.push_back(static_cast<int>(i));
  return inside;
}

void check_nodes(const Body& body, const AttachmentSpec& spec, const std::vector<int>& nodes) {
  if (!nodes.empty()) return;
  const std::string where = fmt::format("body \"{}\": attachment", body.name);
  if (spec.region == Selection::kBox)
    fail("{} box [{}, {}, {}] to [{}, {}, {}] m contains no node; enlarge it or move it over the body", where,
         spec.box_min_m.x(), spec.box_min_m.y(), spec.box_min_m.z(), spec.box_max_m.x(), spec.box_max_m.y(),
         spec.box_max_m.z());
  if (spec.region == Selection::kSphere)
    fail(
        "{} sphere of radius {} m about [{}, {}, {}] m contains no node; enlarge it or move it over the body",
        where, spec.radius_m, spec.centre_m.x(), spec.centre_m.y(), spec.centre_m.z());
  fail(
      "{}: no node lies inside \"{}\"; move it into the body, refine the mesh, or select nodes by a box or a "
      "sphere",
      where, spec.to);
}

/// Motion of the nodes of an attachment, and the frame in which they are fixed at the start.
struct Carrier {
  int block_id = -1;    ///< Rigid block; -1: none.
  dynamics::Path path;  ///< Function of time; empty: none. Without either, the nodes are fixed.
  Pose start;
  std::vector<int>* dofs = nullptr;  ///< List of dofs that a bone carries, if any.
};

/// Keyframes move the region about its centre: x(t) = centre + position(t) + R(t) (x0 - centre).
Carrier along_keyframes(const AttachmentSpec& spec) {
  const Vec3 centre =
      spec.region == Selection::kSphere ? spec.centre_m : Vec3(0.5 * (spec.box_min_m + spec.box_max_m));
  return {
      -1,
      [keyframes = spec.keyframes, centre](double t) {
        const device::HandleSample s = device::sample_keyframes(keyframes, t);
        return dynamics::PathPoint{{s.pose.rotation, s.pose.translation + centre}, s.twist, s.acceleration};
      },
      {Quat::Identity(), centre},
      nullptr};
}

Pose start_of(const ToolSpec& tool) { return {quaternion_of(tool.rotation_vector_rad), tool.position_m}; }

Carrier carrier_of(World& world, const Body& body, const AttachmentSpec& spec) {
  if (spec.to.empty()) return spec.keyframes.empty() ? Carrier{} : along_keyframes(spec);
  for (Bone& bone : world.bones)
    if (bone.name == spec.to) {
      const BoneSpec& placed = *spec_of(world, spec.to);
      return {bone.block_id,
              bone.path,
              {quaternion_of(placed.rotation_vector_rad), placed.position_m},
              &bone.dofs};
    }
  const ToolInstance* const tool = world.find_tool(spec.to);
  if (!tool) fail("body \"{}\": attachment to = \"{}\" is neither a bone nor a tool", body.name, spec.to);
  return {tool->monolithic()->block_id, {}, start_of(tool->spec), nullptr};
}

/// Stiffness ratio of the spring of a node carried by a tool with ticks to the tissue around the node.
constexpr double kStiffer = 100.0;

// A tool with separate ticks is not a block of the State, so the nodes that it carries are tied to it by
// springs. A node of volume V is held by its neighbours with a stiffness of about E a, a = V^(1/3). Its
// spring has k = kStiffer E a, and a damper in the same ratio to the spring as in the tissue. A region of
// size R, with at least (R/a)^2 nodes on a cut through it, has a stiffness of E R, and its springs have
// kStiffer E a (R/a)^2: relative to the body, the springs deflect by a/(kStiffer R).
void tie(const Body& body, const SoftBodySpec& tissue, const std::vector<int>& nodes, int first,
         ToolInstance& tool) {
  const Pose from_world = start_of(tool.spec).inverse();
  for (const int node : nodes) {
    const double length = std::cbrt(body.masses[node] / tissue.density_kg_m3),
                 stiffness = kStiffer * tissue.youngs_modulus_pa * length;
    tool.partitioned()->ties.push_back({first + node, from_world * Vec3(body.placed.col(node)), stiffness,
                                        stiffness * tissue.stiffness_damping_s});
  }
}

/// Index of the attachment that holds or drives each direction of the body's nodes.
using OwnersOfDofs = std::map<int, std::size_t>;

/// @param first  index of the body's first node
void take_dofs(const Body& body, const std::vector<int>& dofs, int first, std::size_t attachment,
               OwnersOfDofs& owners) {
  for (const int dof : dofs) {
    const auto [at, is_free] = owners.emplace(dof, attachment);
    if (is_free) continue;
    const Vec3 node = body.placed.col(dof / 3 - first);
    fail(
        "body \"{}\": attachment {} overlaps attachment {}: both hold or drive the node at [{:g}, {:g}, "
        "{:g}] m along {}; make one of them smaller, or use other axes",
        body.name, attachment + 1, at->second + 1, node.x(), node.y(), node.z(), "xyz"[dof % 3]);
  }
}

bool is_fixed(const AttachmentSpec& spec) { return spec.to.empty() && spec.keyframes.empty(); }

/// Fixes the midpoints between two nodes that different attachments fix in the same direction. Before the
/// division the edge between them did not move in it.
void fix_between(World& world, const Body& body, const SoftBodySpec& tissue, OwnersOfDofs& owners) {
  const int first = world.state.layout().find(body.block_id)->u_offset / 3;
  const auto owner = [&](int node, int axis) {
    const auto found = owners.find(3 * (first + node) + axis);
    return found == owners.end() ? nullptr : &*found;
  };
  std::vector<int> dofs;
  for (const Midpoint& m : body.midpoints)
    for (int axis = 0; axis < 3; ++axis) {
      const auto *const a = owner(m.a, axis), *const b = owner(m.b, axis);
      if (!a || !b || owner(m.node, axis)) continue;
      if (!is_fixed(tissue.attachments[a->second]) || !is_fixed(tissue.attachments[b->second])) continue;
      dofs.push_back(3 * (first + m.node) + axis);
      owners.emplace(dofs.back(), a->second);
    }
  if (dofs.empty()) return;
  std::sort(dofs.begin(), dofs.end());
  VecX x0(static_cast<Eigen::Index>(dofs.size()));
  for (std::size_t i = 0; i < dofs.size(); ++i)
    x0[static_cast<Eigen::Index>(i)] = body.placed(dofs[i] % 3, dofs[i] / 3 - first);
  world.system.add(fem::make_fixed(dofs, x0));
}

/// @param number  index of the attachment among those of the body
void attach(World& world, const Body& body, const SoftBodySpec& tissue, std::size_t number,
            OwnersOfDofs& owners) {
  const AttachmentSpec& spec = tissue.attachments[number];
  const std::vector<int> nodes = nodes_inside(world, body, spec);
  check_nodes(body, spec, nodes);
  const int first = world.state.layout().find(body.block_id)->u_offset / 3;
  ToolInstance* const tool = spec_of(world, spec.to) ? nullptr : world.find_tool(spec.to);
  if (tool && !world.monolithic()) return tie(body, tissue, nodes, first, *tool);
  const Carrier carrier = carrier_of(world, body, spec);
  const std::vector<int> dofs = fem::dofs_of_nodes(nodes, first, spec.axes);
  take_dofs(body, dofs, first, number, owners);
  const Pose from_world = carrier.start.inverse();
  VecX x0(static_cast<Eigen::Index>(dofs.size()));
  Points local(3, x0.size());
  for (Eigen::Index i = 0; i < x0.size(); ++i) {
    const int dof = dofs[static_cast<std::size_t>(i)] - 3 * first;
    x0[i] = body.placed(dof % 3, dof / 3);
    local.col(i) = from_world * Vec3(body.placed.col(dof / 3));
  }
  if (carrier.block_id >= 0)
    world.system.add(fem::make_carried(dofs, local, carrier.block_id));
  else if (carrier.path)
    world.system.add(fem::make_driven(dofs, local, carrier.path));
  else
    world.system.add(fem::make_fixed(dofs, x0));
  if (!carrier.dofs) return;
  carrier.dofs->insert(carrier.dofs->end(), dofs.begin(), dofs.end());
  std::sort(carrier.dofs->begin(), carrier.dofs->end());
}

}  // namespace

void assemble_attachments(World& world) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const SoftBodySpec& spec = world.description.bodies[i];
    OwnersOfDofs owners;
    for (std::size_t k = 0; k < spec.attachments.size(); ++k)
      at_place(world, fmt::format("body[{}].attachment[{}]", i, k), fmt::format("body \"{}\"", spec.name),
               [&] { attach(world, world.bodies[i], spec, k, owners); });
    fix_between(world, world.bodies[i], spec, owners);
  }
}

}  // namespace palpate::loop
