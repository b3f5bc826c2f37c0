#pragma once
#include "palpate/mesh/mesh.h"

namespace palpate::proxy {

/// The surface of the convex hull of points in space, its faces outward: each flat facet a fan of triangles.
/// Of points in a plane, on a line or in one place: no faces.
/// @throws InternalError for no points, or points that are not finite
TriMesh hull_surface(const Points& points);

}  // namespace palpate::proxy
