#include "contact/resultants.h"

#include <algorithm>

namespace palpate::contact {
namespace {

/// Returns the mean position of the block that contains this node.
Vec3 centre_of_block(int node, const dynamics::StateView& state) {
  for (const dynamics::Block& block : state.layout->blocks) {
    if (block.kind != dynamics::BlockKind::kNodes || 3 * node < block.u_offset ||
        3 * node >= block.u_offset + block.u_size)
      continue;
    return Eigen::Map<const Points>(state.q.data() + block.q_offset, 3, block.q_size / 3).rowwise().mean();
  }
  return Vec3::Zero();
}

}  // namespace

void Resultants::start(std::size_t pairs) {
  before.assign(pairs, Wrench{});
  after.assign(pairs, Wrench{});
  bodies_.resize(pairs);
}

void Resultants::find_bodies(const Samples& samples, const dynamics::StateView& state,
                             const std::vector<std::shared_ptr<MovingFrame>>& frames) {
  std::size_t unknown = 0;
  for (const Bodies& bodies : bodies_) unknown += !bodies.known;
  for (const ContactSample& s : samples) {
    if (unknown == 0) return;
    Bodies& bodies = bodies_[static_cast<std::size_t>(s.source)];
    if (bodies.known) continue;
    bodies.known = true;
    --unknown;
    const auto add = [&](const SurfacePoint& side) {
      if (side.frame < 0) {
        bodies.centres.push_back(centre_of_block(side.node[0], state));
      } else if (const MovingFrame& frame = *frames[static_cast<std::size_t>(side.frame)]; frame.moves()) {
        bodies.centres.push_back(frame.pose(state).translation);
      }
    };
    add(s.a);
    add(s.b);
  }
}

// With the moment M about the world's origin, the moment about c is M - c x F. Side b has the opposite of
// both.
void Resultants::compare(const Samples& samples_before, const Samples& samples_after,
                         const dynamics::StateView& state,
                         const std::vector<std::shared_ptr<MovingFrame>>& frames, ContactStatistics& out) {
  for (Bodies& bodies : bodies_) {
    bodies.known = false;
    bodies.centres.clear();
  }
  find_bodies(samples_after, state, frames);
  find_bodies(samples_before, state, frames);
  ResultantSize& jump = out.refresh_jump;
  jump = {};
  const auto grow = [](ResultantSize& size, const Vec3& force, const Vec3& moment, const Bodies& bodies) {
    size.force = std::max(size.force, force.norm());
    for (const Vec3& c : bodies.centres)
      size.moment = std::max(size.moment, (moment - c.cross(force)).norm());
  };
  for (std::size_t i = 0; i < before.size(); ++i) {
    grow(jump, after[i].force - before[i].force, after[i].moment - before[i].moment, bodies_[i]);
    grow(out.largest_resultant, after[i].force, after[i].moment, bodies_[i]);
  }
  out.largest_jump.force = std::max(out.largest_jump.force, jump.force);
  out.largest_jump.moment = std::max(out.largest_jump.moment, jump.moment);
}

}  // namespace palpate::contact
