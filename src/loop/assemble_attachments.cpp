#include <algorithm>

#include "assemble_parts.h"
#include "palpate/bones/shape.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/rigid_body.h"
#include "tool_side.h"

namespace palpate::loop {
namespace {

const BoneSpec* spec_of(const World& world, const std::string& bone) {
  for (const BoneSpec& spec : world.description.bones)
    if (spec.name == bone) return &spec;
  return nullptr;
}

std::vector<int> nodes_inside(const World& world, const Body& body, const AttachmentSpec& spec) {
  if (spec.region == "box") return fem::nodes_in_box(body.placed, spec.box_min_m, spec.box_max_m);
  if (spec.region == "sphere") return fem::nodes_in_sphere(body.placed, spec.centre_m, spec.radius_m);
  const BoneSpec* bone = spec_of(world, spec.to);
  if (!bone)
    return fem::nodes_in_sphere(body.placed, world.description.tool->position_m,
                                world.description.tool->radius_m);
  const Pose from_world = Pose{quaternion_of(bone->rotation_vector_rad), bone->position_m}.inverse();
  std::vector<int> out;
  for (int i = 0; i < body.placed.cols(); ++i)
    if (bones::inside_bone(*bone, from_world * Vec3(body.placed.col(i)))) out.push_back(i);
  return out;
}

void check_nodes(const Body& body, const AttachmentSpec& spec, const std::vector<int>& nodes) {
  if (!nodes.empty()) return;
  const std::string where = fmt::format("body \"{}\": attachment", body.name);
  if (spec.region == "box")
    fail("{} box [{}, {}, {}] to [{}, {}, {}] m holds no node; enlarge it or move it over the body", where,
         spec.box_min_m.x(), spec.box_min_m.y(), spec.box_min_m.z(), spec.box_max_m.x(), spec.box_max_m.y(),
         spec.box_max_m.z());
  if (spec.region == "sphere")
    fail("{} sphere of radius {} m about [{}, {}, {}] m holds no node; enlarge it or move it over the body",
         where, spec.radius_m, spec.centre_m.x(), spec.centre_m.y(), spec.centre_m.z());
  fail(
      "{}: no node lies inside \"{}\"; move it into the body, refine the mesh, or choose nodes by a box or a "
      "sphere",
      where, spec.to);
}

/// Motion of the nodes of an attachment, and the frame that they are fixed in at the start.
struct Carrier {
  int block_id = -1;    ///< a rigid block, or
  dynamics::Path path;  ///< a function of time; neither: they stay
  Pose start;
  std::vector<int>* dofs = nullptr;  ///< where a bone keeps a list of what it carries
};

/// Keyframes move the region about its own centre: x(t) = centre + position(t) + R(t) (x0 - centre).
Carrier along_keyframes(const AttachmentSpec& spec) {
  const Vec3 centre = spec.region == "sphere" ? spec.centre_m : Vec3(0.5 * (spec.box_min_m + spec.box_max_m));
  return {
      -1,
      [keyframes = spec.keyframes, centre](double t) {
        const device::HandleSample s = device::sample_keyframes(keyframes, t);
        return dynamics::PathPoint{{s.pose.rotation, s.pose.translation + centre}, s.twist, s.acceleration};
      },
      {Quat::Identity(), centre},
      nullptr};
}

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
  if (spec.to != "tool" || !world.monolithic())
    fail("body \"{}\": attachment to = \"{}\" is neither a bone nor the tool of a monolithic scheme",
         body.name, spec.to);
  return {ToolSide::of(world).block_id, {}, world.tool_pose(), nullptr};
}

void attach(World& world, const Body& body, const AttachmentSpec& spec) {
  const std::vector<int> nodes = nodes_inside(world, body, spec);
  check_nodes(body, spec, nodes);
  const Carrier carrier = carrier_of(world, body, spec);
  const int first = world.state.layout().find(body.block_id)->u_offset / 3;
  const std::vector<int> dofs = fem::dofs_of_nodes(nodes, first, spec.axes);
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
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    for (const AttachmentSpec& attachment : world.description.bodies[i].attachments)
      attach(world, world.bodies[i], attachment);
}

}  // namespace palpate::loop
