#include "contact/surface_state.h"

#include "palpate/core/error.h"

namespace palpate::contact {

SurfaceState::SurfaceState(NodeSurface surface) : surface_(std::move(surface)), positions_(3, vertex_count()) {
  for (int f = 0; f < face_count(); ++f)
    for (int k = 0; k < 3; ++k)
      PALPATE_CHECK(surface_.faces(k, f) >= 0 && surface_.faces(k, f) < vertex_count(), "contact surface: face {} names vertex {} of {}", f,
                    surface_.faces(k, f), vertex_count());
}

void SurfaceState::update(const dynamics::StateView& state) {
  const dynamics::Block* block = state.layout->find(surface_.block_id);
  PALPATE_CHECK(block && block->kind == dynamics::BlockKind::kNodes, "contact surface: block {} is no node block of this State", surface_.block_id);
  if (const int offset = block->u_offset / 3; offset != node_offset_) {
    node_offset_ = offset;
    ++pattern_version_;
  }
  for (int v = 0; v < vertex_count(); ++v) positions_.col(v) = state.position(node(v));
  PALPATE_CHECK(positions_.allFinite(), "contact query at t = {}: a surface position is not finite", state.time);
}

// Area vector of a face: (x1 - x0) x (x2 - x0) / 2, outward.
void SurfaceState::area_vectors(const std::vector<char>& wanted, Points& areas) const {
  areas.setZero(3, vertex_count());
  for (int f = 0; f < face_count(); ++f) {
    const int i = surface_.faces(0, f), j = surface_.faces(1, f), k = surface_.faces(2, f);
    if (!wanted[static_cast<std::size_t>(i)] && !wanted[static_cast<std::size_t>(j)] && !wanted[static_cast<std::size_t>(k)]) continue;
    const Vec3 edge1 = positions_.col(j) - positions_.col(i), edge2 = positions_.col(k) - positions_.col(i);
    const Vec3 third = edge1.cross(edge2) / 6.0;
    for (const int v : {i, j, k}) areas.col(v) += third;
  }
}

double SurfaceState::mean_edge() const {
  double sum = 0.0;
  for (int f = 0; f < face_count(); ++f)
    for (int k = 0; k < 3; ++k) sum += (positions_.col(surface_.faces(k, f)) - positions_.col(surface_.faces((k + 1) % 3, f))).norm();
  return face_count() > 0 ? sum / (3.0 * face_count()) : 0.0;
}

void SurfaceState::add_face_pattern(dynamics::PatternBuilder& pattern) const {
  for (int f = 0; f < face_count(); ++f) {
    const int nodes[3] = {node(surface_.faces(0, f)), node(surface_.faces(1, f)), node(surface_.faces(2, f))};
    pattern.add_clique(nodes, 3);
  }
}

SurfacePoint vertex_point(int node) {
  SurfacePoint point;
  point.count = 1;
  point.node[0] = node;
  point.weight[0] = 1.0;
  return point;
}

SurfacePoint frame_point(int frame, const Pose& inverse_pose, const Vec3& world) {
  SurfacePoint point;
  point.frame = frame;
  point.offset = inverse_pose * world;
  return point;
}

}  // namespace palpate::contact
