#include "palpate/loop/world.h"

#include <algorithm>

#include "palpate/core/error.h"
#include "palpate/dynamics/rigid_body.h"

#include "bones/tree.h"
#include "tool_instance.h"

namespace palpate::loop {

World::World() = default;
World::~World() = default;

Points Body::surface_points(const Points& nodes) const {
  if (!skin) return nodes(Eigen::all, boundary.node_of_vertex);
  Points out;
  mesh::evaluate(skin->embedding, rest.tets, nodes, out);
  return out;
}

VecX Body::surface_values(const VecX& at_nodes) const {
  if (!skin) return at_nodes(boundary.node_of_vertex);
  VecX out(skin->embedding.size());
  for (Eigen::Index v = 0; v < out.size(); ++v)
    out[v] = skin->embedding.weights.col(v).dot(
        at_nodes(rest.tets.col(skin->embedding.tet[static_cast<std::size_t>(v)])));
  return out;
}

Tets Body::file_tets() const {
  return rest.tets.unaryExpr([&](int node) { return file_node[static_cast<std::size_t>(node)]; });
}

const Body* World::find_body(const std::string& name) const {
  for (const Body& b : bodies)
    if (b.name == name) return &b;
  return nullptr;
}

ToolInstance* World::find_tool(const std::string& name) {
  const auto at =
      std::find_if(tools.begin(), tools.end(), [&](const ToolInstance& tool) { return tool.name == name; });
  return at == tools.end() ? nullptr : &*at;
}

void World::set_youngs_modulus(Body& body, double youngs_modulus_pa, const std::string& region) {
  std::vector<fem::Material> materials = body.term->materials();
  const auto set = [&](int material, double value) {
    materials[static_cast<std::size_t>(material)].youngs_modulus = value;
  };
  if (region.empty()) {
    set(0, youngs_modulus_pa);
    for (const Region& r : body.regions)
      if (r.material > 0 && !r.own_stiffness) set(r.material, r.stiffness_factor * youngs_modulus_pa);
  } else {
    const auto found = std::find_if(body.regions.begin(), body.regions.end(),
                                    [&](const Region& r) { return r.name == region && r.material > 0; });
    if (found == body.regions.end()) {
      std::vector<std::string> names;
      for (const Region& r : body.regions)
        if (r.material > 0) names.push_back(r.name);
      fail("body \"{}\": no region \"{}\" with a separate material{}", body.name, region,
           suggestion(region, names));
    }
    set(found->material, youngs_modulus_pa);
  }
  body.term->set_materials(materials);
  if (body.dilatation) body.dilatation->set_materials(materials);
  for (Region& r : body.regions)
    if (!region.empty() && r.name == region) r.own_stiffness = true;
  if (stepper) stepper->reinit(dynamics::ReinitReason::kParametersChanged);
}

Points World::positions(const Body& body) const {
  const dynamics::Block* block = state.layout().find(body.block_id);
  return Eigen::Map<const Points>(state.q().data() + block->q_offset, 3, block->q_size / 3);
}

namespace {

dynamics::RigidMotion motion_of(const World& world, const Bone& bone) {
  if (bone.path) {
    const dynamics::PathPoint at = bone.path(world.state.time());
    return {at.pose, at.twist};
  }
  const dynamics::StateView view = world.state.view();
  if (bone.tree) {
    const dynamics::Block& block = *view.layout->find(bone.block_id);
    return bone.tree->motion(view.q.segment(block.q_offset, block.q_size),
                             view.u.segment(block.u_offset, block.u_size), bone.tree_bone);
  }
  return dynamics::motion_of(view, dynamics::rigid_block_of(view, bone.block_id));
}

}  // namespace

Pose World::bone_pose(const Bone& bone) const { return motion_of(*this, bone).pose; }
Twist World::bone_twist(const Bone& bone) const { return motion_of(*this, bone).twist; }

std::vector<Wrench> World::wrenches_on_bones() {
  std::vector<Wrench> out(bones.size());
  if (bones.empty()) return out;
  VecX held;
  system.reactions(state.view(), held);
  for (std::size_t i = 0; i < bones.size(); ++i) {
    const Vec3 origin = bone_pose(bones[i]).translation;
    for (const int dof : bones[i].dofs) {
      const Vec3 force = -held[dof] * Vec3::Unit(dof % 3);
      out[i] += {(state.view().position(dof / 3) - origin).cross(force), force};
    }
  }
  return out;
}

// For a monolithic tool, kinetic energy, weight and coupling are terms of the System.
double World::mechanical_energy() {
  const dynamics::StateView view = state.view();
  double energy = system.kinetic_energy(view) + system.potential_energy(view);
  for (const ToolInstance& tool : tools)
    if (const PartitionedTool* partitioned = tool.partitioned())
      energy += partitioned->tool.kinetic_energy() + partitioned->tool.potential_energy(tool.handle.pose);
  return energy;
}

bool World::monolithic() const { return !tools.empty() && tools.front().monolithic(); }
bool World::has_tool_of_ticks() const { return !tools.empty() && tools.front().partitioned(); }
int World::tool_frame_index() const { return tools.empty() ? -1 : tools.front().frame; }

Pose World::tool_pose(std::size_t hand) const {
  if (const PartitionedTool* partitioned = tools.at(hand).partitioned())
    return partitioned->path->last().pose;
  return tools[hand].monolithic()->motion(state.view()).pose;
}

Twist World::tool_twist(std::size_t hand) const {
  if (const PartitionedTool* partitioned = tools.at(hand).partitioned())
    return partitioned->path->last().twist;
  return tools[hand].monolithic()->motion(state.view()).twist;
}

void World::refresh_contact() {
  PALPATE_CHECK(contact, "refresh_contact() called for a World without contact");
  for (ToolInstance& tool : tools)
    if (PartitionedTool* partitioned = tool.partitioned()) partitioned->path->restart();
  contact->refresh(state.view());
}

}  // namespace palpate::loop
