#pragma once
#include <vector>

#include "mesh/layered_model.h"
#include "proxy/convex_hull.h"

namespace palpate::proxy {

/// Quality of one hull as an approximation of its skin, at rest.
struct HullQuality {
  double volume = 0.0;   ///< [m^3]
  double outside = 0.0;  ///< convexity: largest distance of a member outside the hull [m]
  /// Tightness: mean distance of the hull's surface from its members along their normals, weighted by area
  /// [m].
  double mean_gap = 0.0;
  double largest_gap = 0.0;  ///< largest of these distances [m]
};

/// Quality of a decomposition.
struct DecomposeReport {
  std::vector<HullQuality> hulls;
  double skin_size = 0.0;    ///< diagonal of the skin's box [m]
  double skin_volume = 0.0;  ///< [m^3]
  double hull_volume = 0.0;  ///< sum over the hulls; neighbours overlap, so more than skin_volume [m^3]
  double largest_outside = 0.0, largest_gap = 0.0;  ///< over all hulls [m]
};

/// Returns the distance from a point in a hull to the hull's surface along a unit normal; 0 outside the hull
/// [m].
double gap_along(const ConvexHull& hull, const Vec3& point, const Vec3& normal);

/// Computes the quality of hulls as an approximation of a skin.
DecomposeReport decompose_report(const TriMesh& skin, const std::vector<ProxyHull>& proxies);

}  // namespace palpate::proxy
