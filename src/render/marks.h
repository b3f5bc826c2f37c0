#pragma once
#include "render/scene.h"

namespace palpate::render {

/// Lines and points as surfaces: hidden, lit and framed as any other surface.

/// Returns the edges of a surface that are sharper than `least_deg`, and its borders, as thin bars; for a
/// convex hull, its edges without the triangulation of its flat facets.
/// @param width  width of a bar [m]
/// @param least_deg  least angle between the normals of adjacent faces [degrees]
Surface outline(const Points& points, const Faces& faces, double width, double least_deg = 1.0);

/// Returns three ellipses in the coordinate planes about the origin, as thin bars: the outline of an
/// ellipsoid that shows its rotation.
/// @param semi_axes  semi-axes of the ellipsoid [m]
/// @param width  width of a bar [m]
Surface rings(const Vec3& semi_axes, double width);

/// Returns a thin bar between two points; empty where they coincide.
/// @param width  width of the bar [m]
Surface bar(const Vec3& from, const Vec3& to, double width);

/// Returns a small octahedron about each point.
/// @param size  tip-to-tip size [m]
Surface dots(const Points& points, double size);

}  // namespace palpate::render
