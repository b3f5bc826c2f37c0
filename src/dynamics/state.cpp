#include "palpate/dynamics/state.h"

#include <algorithm>
#include <atomic>

#include "palpate/core/error.h"

namespace palpate::dynamics {
namespace {

std::uint64_t fresh_state_version() {
  static std::atomic<std::uint64_t> next{1};
  return next++;
}

/// Sets offsets and sizes from the order of the blocks.
void place_blocks(Layout& layout) {
  layout.q_size = layout.u_size = layout.nodal_size = 0;
  for (Block& b : layout.blocks) {
    b.q_offset = layout.q_size;
    b.u_offset = layout.u_size;
    layout.q_size += b.q_size;
    layout.u_size += b.u_size;
    if (b.kind == BlockKind::kNodes) layout.nodal_size += b.u_size;
  }
  layout.version = fresh_state_version();
}

void check_spec(const BlockSpec& spec, const ConstSegment& q, const ConstSegment& u) {
  PALPATE_CHECK(spec.q_size == q.size() && spec.u_size == u.size(),
                "block \"{}\": q has {} of {} entries, u {} of {}", spec.name, q.size(), spec.q_size,
                u.size(), spec.u_size);
  PALPATE_CHECK(spec.kinematics || spec.q_size == spec.u_size,
                "block \"{}\": q' = u needs equal sizes, got {} and {}", spec.name, spec.q_size, spec.u_size);
  PALPATE_CHECK(spec.kind != BlockKind::kNodes || (spec.u_size % 3 == 0 && !spec.kinematics),
                "node block \"{}\" has {} velocities; it needs three per node, and no kinematics", spec.name,
                spec.u_size);
  PALPATE_CHECK(spec.q_scale > 0.0 && spec.u_scale > 0.0, "block \"{}\": scales {} and {} must be positive",
                spec.name, spec.q_scale, spec.u_scale);
}

}  // namespace

State::State(int q_capacity, int u_capacity, int block_capacity) {
  q_.reserve(static_cast<std::size_t>(q_capacity));
  u_.reserve(static_cast<std::size_t>(u_capacity));
  layout_.blocks.reserve(static_cast<std::size_t>(block_capacity));
}

int State::insert(const BlockSpec& spec, const ConstSegment& q, const ConstSegment& u) {
  check_spec(spec, q, u);
  const bool nodes = spec.kind == BlockKind::kNodes;
  auto place = layout_.blocks.end();
  if (nodes)
    place = std::find_if(layout_.blocks.begin(), layout_.blocks.end(),
                         [](const Block& b) { return b.kind != BlockKind::kNodes; });
  const auto q_at = place == layout_.blocks.end() ? layout_.q_size : place->q_offset;
  const auto u_at = place == layout_.blocks.end() ? layout_.u_size : place->u_offset;
  q_.insert(q_.begin() + q_at, q.data(), q.data() + q.size());
  u_.insert(u_.begin() + u_at, u.data(), u.data() + u.size());
  Block block;
  static_cast<BlockSpec&>(block) = spec;
  block.id = next_id_++;
  layout_.blocks.insert(place, block);
  place_blocks(layout_);
  return block.id;
}

BlockSpec State::extract(int id, VecX& q, VecX& u) {
  const auto it =
      std::find_if(layout_.blocks.begin(), layout_.blocks.end(), [id](const Block& b) { return b.id == id; });
  PALPATE_CHECK(it != layout_.blocks.end(), "no block with id {}", id);
  const BlockSpec spec = *it;
  const auto q_first = q_.begin() + it->q_offset;
  const auto u_first = u_.begin() + it->u_offset;
  q = Eigen::Map<const VecX>(q_.data() + it->q_offset, it->q_size);
  u = Eigen::Map<const VecX>(u_.data() + it->u_offset, it->u_size);
  q_.erase(q_first, q_first + it->q_size);
  u_.erase(u_first, u_first + it->u_size);
  layout_.blocks.erase(it);
  place_blocks(layout_);
  return spec;
}

StateView State::view(double t, const double* q, const double* u) const {
  return make_view(layout_, t, q, u);
}

StateView make_view(const Layout& layout, double t, const double* q, const double* u) {
  StateView view;
  view.layout = &layout;
  view.time = t;
  new (&view.q) Eigen::Map<const VecX>(q, layout.q_size);  // an Eigen::Map is re-seated by placement new
  new (&view.u) Eigen::Map<const VecX>(u, layout.u_size);
  return view;
}

void q_dot(const Layout& layout, const double* q, const double* u, double* out) {
  for (const Block& b : layout.blocks) {
    const Eigen::Map<const VecX> qb(q + b.q_offset, b.q_size), ub(u + b.u_offset, b.u_size);
    Eigen::Map<VecX> ob(out + b.q_offset, b.q_size);
    if (b.kinematics)
      b.kinematics->q_dot(qb, ub, ob);
    else
      ob = ub;
  }
}

void project(const Layout& layout, double* q) {
  for (const Block& b : layout.blocks)
    if (b.kinematics) b.kinematics->project(Eigen::Map<VecX>(q + b.q_offset, b.q_size));
}

}  // namespace palpate::dynamics
