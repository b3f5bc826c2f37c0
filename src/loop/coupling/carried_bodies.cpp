#include "carried_bodies.h"

#include <algorithm>

namespace palpate::loop {

// With equal positions r = r' of a node in the tool's axes before and now, and Q the rotation of these axes,
//     x' = p' + Q (x - p),      u' = v'(x') + Q (u - v(x)),
// with v the velocity of the tool's material at a point.
void carry_along(dynamics::State& state, const std::vector<contact::Tie>& ties,
                 const dynamics::RigidMotion& before, const dynamics::RigidMotion& now) {
  const Quat turn = now.pose.rotation * before.pose.rotation.conjugate();
  auto q = state.q();
  auto u = state.u();
  for (const dynamics::Block& block : state.layout().blocks) {
    if (block.kind != dynamics::BlockKind::kNodes) continue;
    const int first = block.u_offset / 3, last = first + block.u_size / 3;
    if (std::none_of(ties.begin(), ties.end(),
                     [&](const contact::Tie& tie) { return tie.node >= first && tie.node < last; }))
      continue;
    for (int node = first; node < last; ++node) {
      const Vec3 arm = q.segment<3>(3 * node) - before.pose.translation, arm_now = turn * arm;
      const Vec3 against = u.segment<3>(3 * node) - before.twist.at(arm);
      q.segment<3>(3 * node) = now.pose.translation + arm_now;
      u.segment<3>(3 * node) = now.twist.at(arm_now) + turn * against;
    }
  }
}

}  // namespace palpate::loop
