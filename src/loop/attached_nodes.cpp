#include "loop/attached_nodes.h"

#include "palpate/fem/attachments.h"

namespace palpate::loop {

std::set<int> driven_nodes(const World& world, std::size_t body) {
  std::set<int> out;
  const Body& of = world.bodies[body];
  const int begin = world.state.layout().blocks[static_cast<std::size_t>(of.block_id)].u_offset;
  const int end = begin + static_cast<int>(3 * of.placed.cols());
  for (const int dof : world.system.driven_dofs())
    if (dof >= begin && dof < end) out.insert((dof - begin) / 3);
  return out;
}

std::set<int> carried_nodes(const World& world, std::size_t body) {
  std::set<int> out;
  const Points& placed = world.bodies[body].placed;
  for (const AttachmentSpec& a : world.description.bodies[body].attachments) {
    if (a.to.empty() || a.region == Selection::kShape) continue;
    for (const int node : a.region == Selection::kBox ? fem::nodes_in_box(placed, a.box_min_m, a.box_max_m)
                                                      : fem::nodes_in_sphere(placed, a.centre_m, a.radius_m))
      out.insert(node);
  }
  return out;
}

}  // namespace palpate::loop
