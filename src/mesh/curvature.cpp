#include "mesh/curvature.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

namespace palpate::mesh {

// The curvature of a polyhedron is concentrated in its edges: the integral of H is half the sum of their
// lengths times the angles between the normals of their faces, positive at convex edges (Cohen-Steiner,
// Morvan 2003).
double mean_radius(const TriMesh& closed) {
  const auto normal = [&](Eigen::Index f) -> Vec3 {
    const Vec3 a = closed.vertices.col(closed.faces(0, f)), b = closed.vertices.col(closed.faces(1, f)),
               c = closed.vertices.col(closed.faces(2, f));
    return (b - a).cross(c - a);
  };
  struct HalfEdge {
    int low, high;  ///< vertices
    bool is_up;     ///< whether its face runs from the lower vertex to the higher one
    Eigen::Index face;
  };
  double area = 0.0, integral = 0.0;
  std::vector<HalfEdge> edges;
  for (Eigen::Index f = 0; f < closed.faces.cols(); ++f) {
    area += 0.5 * normal(f).norm();
    for (int k = 0; k < 3; ++k) {
      const int from = closed.faces(k, f), to = closed.faces((k + 1) % 3, f);
      edges.push_back({std::min(from, to), std::max(from, to), from < to, f});
    }
  }
  const auto key = [](const HalfEdge& e) { return std::tuple(e.low, e.high, e.is_up, e.face); };
  std::sort(edges.begin(), edges.end(),
            [&](const HalfEdge& a, const HalfEdge& b) { return key(a) < key(b); });
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const HalfEdge &down = edges[i], &up = edges[i + 1];
    if (down.low != up.low || down.high != up.high || down.is_up == up.is_up) continue;
    const Vec3 edge = closed.vertices.col(up.high) - closed.vertices.col(up.low), n = normal(up.face),
               m = normal(down.face), turn = m.cross(n);
    integral += 0.5 * edge.norm() * std::copysign(std::atan2(turn.norm(), m.dot(n)), -turn.dot(edge));
  }
  return integral > 0.0 ? area / integral : HUGE_VAL;
}

}  // namespace palpate::mesh
