#include "contact/vertex_rule.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace palpate::contact {

void VertexRule::find(const Region& region, std::span<const FacePair> pairs, std::vector<Hit>& out) {
  pair_at_.assign(
      static_cast<std::size_t>(region.camera.width) * static_cast<std::size_t>(region.camera.height), -1);
  for (std::size_t i = 0; i < pairs.size(); ++i) pair_at_[pairs[i].at] = static_cast<std::int32_t>(i);
  out.clear();
  find_on_side(region, true, pairs, out);
  if (region.both_sides) find_on_side(region, false, pairs, out);
}

void VertexRule::collect(const Patch& patch, double side, double share) {
  vertices_.assign(static_cast<std::size_t>(patch.uvw.cols()), {});
  for (std::size_t i = 0; i < patch.visible.size(); ++i) {
    const auto corner = patch.faces->col(patch.visible[i]);
    const auto p = [&](int k) { return patch.uvw.col(corner[k]).head<2>(); };
    const Eigen::Vector2d e = p(1) - p(0), f = p(2) - p(0);
    const double area = 0.5 * side * (e.x() * f.y() - e.y() * f.x());
    if (!(area > 0.0)) continue;  // Turned away.
    for (int k = 0; k < 3; ++k) {
      Vertex& vertex = vertices_[static_cast<std::size_t>(corner[k])];
      vertex.area += share * area / 3.0;
      if (area <= vertex.largest) continue;
      vertex.largest = area;
      vertex.visible = static_cast<int>(i);
      vertex.corner = k;
    }
  }
}

void VertexRule::find_on_side(const Region& region, bool of_a, std::span<const FacePair> pairs,
                              std::vector<Hit>& out) {
  const Patch &own = of_a ? region.a : region.b, &other = of_a ? region.b : region.a;
  collect(own, of_a ? -1.0 : 1.0, region.both_sides ? 0.5 : 1.0);
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const Vertex& vertex = vertices_[i];
    if (vertex.visible < 0) continue;
    const int face = opposite(region, of_a, static_cast<int>(i), pairs);
    if (face < 0) continue;
    const Vec3 x = own.uvw.col(static_cast<Eigen::Index>(i));
    Hit hit;
    hit.at.u = x.x();
    hit.at.v = x.y();
    (of_a ? hit.at.w_a : hit.at.w_b) = x.z();
    (of_a ? hit.at.weights_a : hit.at.weights_b) = Vec3::Unit(vertex.corner);
    (of_a ? region.planes_b : region.planes_a)
        .at(face, x.x(), x.y(), of_a ? hit.at.weights_b : hit.at.weights_a, of_a ? hit.at.w_b : hit.at.w_a);
    if (!(hit.at.gap() < region.candidate_gap)) continue;
    const int own_face = own.visible[static_cast<std::size_t>(vertex.visible)],
              other_face = other.visible[static_cast<std::size_t>(face)];
    hit.face_a = of_a ? own_face : other_face;
    hit.face_b = of_a ? other_face : own_face;
    hit.area = vertex.area;
    out.push_back(hit);
  }
  // Sorted by position, independent of the order of triangles in the mesh.
  std::sort(out.begin() + first, out.end(), [](const Hit& p, const Hit& q) {
    return std::tie(p.at.v, p.at.u, p.at.w_a, p.at.w_b) < std::tie(q.at.v, q.at.u, q.at.w_a, q.at.w_b);
  });
}

/// Finds the other body's triangle on the line through a vertex, from the surrounding pixels at which the
/// image shows the vertex' skin: a face of the vertex, or a face at its height within the resolution of a
/// pixel.
/// @return index into the other patch's `visible`; -1: the image shows no such triangle, or not the vertex
int VertexRule::opposite(const Region& region, bool of_a, int vertex, std::span<const FacePair> pairs) const {
  const ContactCamera& camera = region.camera;
  const Patch& own = of_a ? region.a : region.b;
  FacePlanes &of_own = of_a ? region.planes_a : region.planes_b,
             &of_other = of_a ? region.planes_b : region.planes_a;
  const Vec3 at = own.uvw.col(vertex);
  const double x = std::floor((at.x() - camera.u0) / camera.pixel),
               y = std::floor((at.y() - camera.v0) / camera.pixel);
  if (!(x >= 0.0 && y >= 0.0 && x < camera.width && y < camera.height)) return -1;
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  int found = -1;
  double least_outside = -std::numeric_limits<double>::infinity();
  for (int j = std::max(0, row - 1); j <= std::min(camera.height - 1, row + 1); ++j)
    for (int i = std::max(0, column - 1); i <= std::min(camera.width - 1, column + 1); ++i) {
      const std::int32_t pair = pair_at_[static_cast<std::size_t>(j * camera.width + i)];
      if (pair < 0) continue;
      const FacePair& faces = pairs[static_cast<std::size_t>(pair)];
      const int seen = static_cast<int>(of_a ? faces.a : faces.b),
                face = static_cast<int>(of_a ? faces.b : faces.a);
      Vec3 weights;
      double w = 0.0;
      const auto corners = own.faces->col(own.visible[static_cast<std::size_t>(seen)]);
      const bool is_own = (corners.array() == vertex).any();
      if (!is_own && !(of_own.at(seen, at.x(), at.y(), weights, w) && std::abs(w - at.z()) < camera.pixel))
        continue;
      if (!of_other.at(face, at.x(), at.y(), weights, w) || weights.minCoeff() <= least_outside) continue;
      least_outside = weights.minCoeff();
      found = face;
    }
  return found;
}

}  // namespace palpate::contact
