#include "proxy/hull_surface.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "proxy/convex_hull.h"

namespace palpate::proxy {

// Qhull lists facets by their planes, flat polygons more than once where it triangulated them.  A facet's
// corners are the hull's corners on its plane, ordered by their angle about their mean.
TriMesh hull_surface(const Points& points) {
  const ConvexHull hull = convex_hull(points);
  TriMesh out{points(Eigen::all, hull.corners), {}};
  if (hull.volume == 0.0) return out;
  const double size = (out.vertices.colwise() - Vec3(out.vertices.col(0))).colwise().norm().maxCoeff();
  const double on_plane = 1e-9 * size;
  std::vector<Eigen::Vector3i> faces;
  for (Eigen::Index f = 0; f < hull.normals.cols(); ++f) {
    const Vec3 n = hull.normals.col(f);
    std::vector<int> corners;
    for (int i = 0; i < out.vertices.cols(); ++i)
      if (n.dot(out.vertices.col(i)) > hull.offsets[f] - on_plane) corners.push_back(i);
    if (corners.size() < 3) continue;
    bool known = false;
    for (Eigen::Index g = 0; g < f && !known; ++g)
      known = std::all_of(corners.begin(), corners.end(), [&](int i) {
        return hull.normals.col(g).dot(out.vertices.col(i)) > hull.offsets[g] - on_plane;
      });
    if (known) continue;
    const Vec3 middle = out.vertices(Eigen::all, corners).rowwise().mean();
    const Vec3 u = (out.vertices.col(corners[0]) - middle).normalized(), v = n.cross(u);
    const auto angle = [&](int i) {
      const Vec3 r = out.vertices.col(i) - middle;
      return std::atan2(r.dot(v), r.dot(u));
    };
    std::sort(corners.begin(), corners.end(), [&](int i, int j) { return angle(i) < angle(j); });
    for (std::size_t k = 2; k < corners.size(); ++k)
      faces.emplace_back(corners[0], corners[k - 1], corners[k]);
  }
  out.faces.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f) out.faces.col(static_cast<Eigen::Index>(f)) = faces[f];
  return out;
}

}  // namespace palpate::proxy
