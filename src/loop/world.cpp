#include "palpate/loop/world.h"

#ifdef PALPATE_HAS_TOOL
#include "palpate/tool/tool.h"
#else
namespace palpate::tool {
class Tool {};
}  // namespace palpate::tool
#endif

namespace palpate::loop {

World::World() = default;
World::~World() = default;

const Body* World::find_body(const std::string& name) const {
  for (const Body& b : bodies)
    if (b.name == name) return &b;
  return nullptr;
}

Points World::positions(const Body& body) const {
  const dynamics::Block* block = state.layout().find(body.block_id);
  return Eigen::Map<const Points>(state.q().data() + block->q_offset, 3, block->q_size / 3);
}

// Of a monolithic tool, mass, weight and coupling are terms of the System.
double World::mechanical_energy() {
  const dynamics::StateView view = state.view();
  double energy = system.kinetic_energy(view) + system.potential_energy(view);
#ifdef PALPATE_HAS_TOOL
  if (tool) energy += tool->kinetic_energy() + tool->potential_energy(handle_now.pose);
#endif
  return energy;
}

#ifdef PALPATE_HAS_TOOL
Pose World::tool_pose() const {
  if (!monolithic()) return tool->pose();
  const auto q = state.q().segment<7>(state.layout().find(tool_block_id)->q_offset);
  return {Quat(q[0], q[1], q[2], q[3]), q.tail<3>()};
}

Twist World::tool_twist() const {
  if (!monolithic()) return tool->twist();
  const auto u = state.u().segment<6>(state.layout().find(tool_block_id)->u_offset);
  return {u.head<3>(), u.tail<3>()};
}
#else
Pose World::tool_pose() const { return {}; }
Twist World::tool_twist() const { return {}; }
#endif

}  // namespace palpate::loop
