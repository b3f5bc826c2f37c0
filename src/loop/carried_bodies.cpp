#include "carried_bodies.h"

#include <algorithm>

namespace palpate::loop {

// With equal positions r = r' of a node in the tool's axes before and now, and Q the rotation of these axes,
//     x' = p' + Q (x - p),      u' = v'(x') + Q (u - v(x)),
// with v the velocity of the tool's material at a point.
void carry_along(World& world, const ToolInstance& side, const Pose& before, const Twist& twist_before) {
  const ExchangedTool& now = side.exchanged;
  const Quat turn = now.pose.rotation * before.rotation.conjugate();
  auto q = world.state.q();
  auto u = world.state.u();
  for (const Body& body : world.bodies) {
    const dynamics::Block* block = world.state.layout().find(body.block_id);
    const int first = block->u_offset / 3, last = first + block->u_size / 3;
    if (std::none_of(side.ties.begin(), side.ties.end(),
                     [&](const contact::Tie& tie) { return tie.node >= first && tie.node < last; }))
      continue;
    for (int node = first; node < last; ++node) {
      const Vec3 arm = q.segment<3>(3 * node) - before.translation, arm_now = turn * arm;
      const Vec3 against = u.segment<3>(3 * node) - twist_before.at(arm);
      q.segment<3>(3 * node) = now.pose.translation + arm_now;
      u.segment<3>(3 * node) = now.twist.at(arm_now) + turn * against;
    }
  }
}

}  // namespace palpate::loop
