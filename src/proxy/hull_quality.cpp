#include "proxy/hull_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/mesh/boundary.h"
#include "palpate/mesh/embedding.h"
#include "proxy/hull.h"

namespace palpate::proxy {
namespace {

HullQuality quality(const ProxyHull& proxy, const Points& vertices, const Points& normals,
                    const VecX& areas) {
  const ConvexHull hull = convex_hull(proxy.corners);
  HullQuality out;
  out.volume = hull.volume;
  const Hull whole(proxy.corners);
  double area = 0.0;
  for (const int v : proxy.members) {
    const Vec3 x = vertices.col(v);
    const double gap = gap_along(hull, x, normals.col(v));
    out.largest_gap = std::max(out.largest_gap, gap);
    out.mean_gap += areas[v] * gap;
    area += areas[v];
    if (hull.beyond(x) > 0.0) {
      const Points point = x;
      out.outside = std::max(out.outside, nearest_difference(Hull(point), whole).norm());
    }
  }
  if (area > 0.0) out.mean_gap /= area;
  return out;
}

}  // namespace

// The ray leaves the hull at the nearest of the planes ahead, (offset - n . x) / (n . m).
double gap_along(const ConvexHull& hull, const Vec3& x, const Vec3& m) {
  double gap = std::numeric_limits<double>::infinity();
  for (Eigen::Index f = 0; f < hull.normals.cols(); ++f)
    if (const double ahead = hull.normals.col(f).dot(m); ahead > 1e-12)
      gap = std::min(gap, (hull.offsets[f] - hull.normals.col(f).dot(x)) / ahead);
  return std::isfinite(gap) ? std::max(gap, 0.0) : 0.0;
}

DecomposeReport decompose_report(const TriMesh& skin, const std::vector<ProxyHull>& proxies) {
  Points normals;
  VecX areas;
  mesh::vertex_normals_and_areas(skin.faces, skin.vertices, normals, areas);
  DecomposeReport out;
  out.skin_size = (skin.vertices.rowwise().maxCoeff() - skin.vertices.rowwise().minCoeff()).norm();
  out.skin_volume = mesh::enclosed_volume(skin);
  for (const ProxyHull& proxy : proxies) {
    const HullQuality& one = out.hulls.emplace_back(quality(proxy, skin.vertices, normals, areas));
    out.hull_volume += one.volume;
    out.largest_outside = std::max(out.largest_outside, one.outside);
    out.largest_gap = std::max(out.largest_gap, one.largest_gap);
  }
  return out;
}

}  // namespace palpate::proxy
