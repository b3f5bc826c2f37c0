#pragma once
#include "proxy/convex_hull.h"
#include "proxy/decompose.h"

namespace palpate::proxy {

/// Returns the distance from a point in a hull to the hull's surface along a unit normal; 0 outside the hull
/// [m].
double gap_along(const ConvexHull& hull, const Vec3& point, const Vec3& normal);

/// Computes the quality of hulls as an approximation of a skin.
DecomposeReport decompose_report(const TriMesh& skin, const std::vector<ProxyHull>& proxies);

}  // namespace palpate::proxy
