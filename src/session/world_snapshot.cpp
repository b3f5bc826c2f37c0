#include "session/world_snapshot.h"

#include "loop/contact_instant.h"
#include "palpate/scene/hands.h"

namespace palpate::session {

WorldSnapshot snapshot_of(loop::World& world, double time, Shade shade) {
  WorldSnapshot out;
  out.time = time;
  for (const loop::Body& body : world.bodies) {
    out.nodes.push_back(world.positions(body));
    if (shade == Shade::kStress) out.stress.push_back(body.nodal_stress(world.state.view()));
  }
  if (shade == Shade::kPenetration)
    for (const VecX& depths : loop::contact_instant(world).depths) {
      auto& list = out.depths.emplace_back();
      for (Eigen::Index v = 0; v < depths.size(); ++v)
        if (depths[v] > 0.0) list.emplace_back(static_cast<int>(v), static_cast<float>(depths[v]));
    }
  for (const loop::Bone& bone : world.bones) out.bones.push_back(world.bone_pose(bone));
  for (std::size_t i = 0; i < scene::hands_of(world.description).size(); ++i)
    out.tools.push_back(world.tool_pose(i));
  return out;
}

}  // namespace palpate::session
