// Which faces an image needs.  First a's faces that face the camera; then of b's those that reach into the
// bounds of a's (in depth: from a's lowest point less the candidate gap upwards).  Then both are cut to the
// window of their overlap (fit_window.h).
//
// Most chunks of faces are wholly inside a window or wholly outside, by their bounding box; faces are tested
// one by one only in the others.  No face of a removed chunk would have been kept, no face of a chunk kept as
// a whole would have been removed, so that the result does not depend on how faces are divided into chunks.
//
// Faces that are turned away matter between the two patches, on lines that meet both (exact_lines.cpp):
// within the window, no lower than the lowest of a, no higher than the highest of b.
#include "contact/region_piece.h"

#include <algorithm>
#include <limits>

#include "contact/face_kernels.h"
#include "contact/fit_window.h"

namespace palpate::contact {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

bool meet(const AxisBox& p, const AxisBox& q) {
  bool out = true;
  for (int k = 0; k < 3; ++k) out &= (p.low[k] <= q.high[k]) & (p.high[k] >= q.low[k]);
  return out;
}
bool is_within(const AxisBox& p, const AxisBox& q) {
  bool out = true;
  for (int k = 0; k < 3; ++k) out &= (p.low[k] >= q.low[k]) & (p.high[k] <= q.high[k]);
  return out;
}
void extend(AxisBox& bounds, const AxisBox& box) {
  bounds.low = bounds.low.cwiseMin(box.low);
  bounds.high = bounds.high.cwiseMax(box.high);
}

/// Bounding boxes of chunks in a region's axes, from those in world axes: conservative.
class ChunkBoxes {
 public:
  explicit ChunkBoxes(const ContactAxes& axes)
      : origin_(axes.origin), turn_(axes.to_world.transpose()), spread_(turn_.cwiseAbs()) {}
  AxisBox of(const RegionMesh::Chunk& chunk) const {
    constexpr double kRounding = 1e-12;
    const Vec3 centre = turn_ * (chunk.centre - origin_);
    Vec3 half = spread_ * chunk.half;
    half.array() += kRounding * (chunk.centre.cwiseAbs().maxCoeff() + origin_.cwiseAbs().maxCoeff());
    return {centre - half, centre + half};
  }

 private:
  Vec3 origin_;
  Mat3 turn_, spread_;
};

/// A face in the axes.
struct Corners {
  const double *p, *q, *r;
  Corners(const std::vector<double>& wide, const Faces& faces, int face)
      : p(wide.data() + 4 * faces(0, face)),
        q(wide.data() + 4 * faces(1, face)),
        r(wide.data() + 4 * faces(2, face)) {}
  double area() const {  // twice, along the normal
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
  }
  AxisBox box() const {
    AxisBox out;
    for (int k = 0; k < 3; ++k) {
      out.low[k] = std::min(p[k], std::min(q[k], r[k]));
      out.high[k] = std::max(p[k], std::max(q[k], r[k]));
    }
    return out;
  }
};

}  // namespace

void RegionPiece::take(const RegionMesh& mesh) {
  mesh_ = &mesh;
  own_.assign(mesh.chunks().size(), 1);
}

AxisBox RegionPiece::bounds() const {
  AxisBox out;
  for (const Seen& seen : seen_) extend(out, seen.box);
  return out;
}

/// Keeps the faces of a chunk for which keep(corners, box), in place.
template <class Keep>
void RegionPiece::keep_faces(Seen& seen, Keep keep) {
  std::size_t kept = seen.first;
  seen.box = {};
  for (std::size_t i = seen.first; i < seen.end; ++i) {
    const Corners corners(wide_, mesh_->faces(), visible_[i]);
    const AxisBox box = corners.box();
    if (!keep(corners, box)) continue;
    extend(seen.box, box);
    visible_[kept++] = visible_[i];
  }
  seen.end = kept;
}

AxisBox RegionPiece::see(const ContactAxes& axes, double side, const AxisBox& within) {
  axes_ = axes;
  side_ = side;
  const Points& world = mesh_->vertices();
  uvw_.resize(3, world.cols());
  wide_.resize(4 * static_cast<std::size_t>(world.cols()));
  // stored column by column, the axes are the rows
  kernels_->to_axes(world.data(), static_cast<int>(world.cols()), axes.to_world.data(), axes.origin.data(),
                    uvw_.data(), wide_.data());
  const ChunkBoxes boxes(axes);
  may_turn_.assign(own_.size(), 1);
  visible_.resize(static_cast<std::size_t>(mesh_->face_count()));
  seen_.clear();
  std::size_t next = 0;
  for (std::size_t i = 0; i < own_.size(); ++i) {
    const RegionMesh::Chunk& chunk = mesh_->chunks()[i];
    if (own_[i] == 0 || !meet(boxes.of(chunk), within)) continue;
    double low[4], high[4];
    const double least_area = kernels_->bound(wide_.data(), mesh_->faces().data() + 3 * chunk.first,
                                              chunk.end - chunk.first, side, low, high);
    Seen seen;
    seen.first = seen.end = next;
    seen.box = {Vec3(low[0], low[1], low[2]), Vec3(high[0], high[1], high[2])};
    for (int face = chunk.first; face < chunk.end; ++face) visible_[seen.end++] = face;
    const bool all_seen = least_area > 0.0;
    may_turn_[i] = !all_seen;
    if (!all_seen || !is_within(seen.box, within))
      keep_faces(seen, [&](const Corners& corners, const AxisBox& box) {
        return (all_seen || side * corners.area() > 0.0) && meet(box, within);
      });
    next = seen.end;
    if (seen.first < seen.end) seen_.push_back(seen);
  }
  return bounds();
}

AxisBox RegionPiece::cut(const AxisBox& window) {
  std::size_t kept = 0;
  for (Seen& seen : seen_) {
    if (!meet(seen.box, window)) continue;
    if (!is_within(seen.box, window))
      keep_faces(seen, [&](const Corners&, const AxisBox& box) { return meet(box, window); });
    if (seen.first < seen.end) seen_[kept++] = seen;
  }
  seen_.resize(kept);
  return bounds();
}

void RegionPiece::finish(const AxisBox& within, Patch& patch) {
  std::size_t next = 0;
  for (const Seen& seen : seen_)
    for (std::size_t i = seen.first; i < seen.end; ++i) visible_[next++] = visible_[i];
  visible_.resize(next);
  away_.clear();
  const ChunkBoxes boxes(axes_);
  for (std::size_t i = 0; i < may_turn_.size(); ++i) {
    const RegionMesh::Chunk& chunk = mesh_->chunks()[i];
    if (may_turn_[i] == 0 || !meet(boxes.of(chunk), within)) continue;
    for (int face = chunk.first; face < chunk.end; ++face) {
      const Corners corners(wide_, mesh_->faces(), face);
      if (!(side_ * corners.area() > 0.0) && meet(corners.box(), within)) away_.push_back(face);
    }
  }
  patch.uvw.swap(uvw_);
  patch.visible.swap(visible_);
  patch.boxes.clear();
  patch.faces = &mesh_->faces();
  patch.away = &away_;
}

ContactWindow fit_window(RegionPiece& of_a, RegionPiece& of_b, const ContactAxes& axes, double candidate_gap,
                         Patch& a, Patch& b) {
  const AxisBox all{Vec3::Constant(-kUnbounded), Vec3::Constant(kUnbounded)};
  const AxisBox box_a = of_a.see(axes, -1.0, all);
  AxisBox within = box_a;
  within.low.z() -= candidate_gap;
  within.high.z() = kUnbounded;
  const AxisBox box_b = of_b.see(axes, 1.0, within);
  const ContactWindow window = cut_to_window(
      box_a, box_b, candidate_gap, [&](const AxisBox& to) { return of_a.cut(to); },
      [&](const AxisBox& to) { return of_b.cut(to); });
  within.low << window.low, window.near;
  within.high << window.high, window.far;
  of_a.finish(within, a);
  of_b.finish(within, b);
  return window;
}

}  // namespace palpate::contact
