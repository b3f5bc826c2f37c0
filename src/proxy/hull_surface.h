#pragma once
#include "palpate/mesh/mesh.h"

namespace palpate::proxy {

/// Returns the surface of the convex hull of points in space, faces outward; each flat facet is a fan of
/// triangles.  Points that lie in a plane, on a line or in one place yield no faces.
/// @throws InternalError for no points, or points that are not finite
TriMesh hull_surface(const Points& points);

}  // namespace palpate::proxy
