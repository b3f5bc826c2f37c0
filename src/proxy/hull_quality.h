#pragma once
#include "palpate/proxy/decompose.h"
#include "proxy/convex_hull.h"

namespace palpate::proxy {

/// How far a hull's surface stands off a point in it, along a unit normal; 0 outside of it [m].
double gap_along(const ConvexHull& hull, const Vec3& point, const Vec3& normal);

/// How well hulls stand for a skin.
DecomposeReport decompose_report(const TriMesh& skin, const std::vector<ProxyHull>& proxies);

}  // namespace palpate::proxy
