#pragma once
#include "palpate/render/scene.h"

namespace palpate::render {

/// Surfaces that stand for lines and points: they are hidden, lit and framed as any other surface is.

/// The edges of a surface that are sharper than `least_deg`, and its borders, as thin bars; of a convex hull
/// its edges without the cuts of its flat facets.
/// @param width  of a bar [m]
Surface outline(const Points& points, const Faces& faces, double width, double least_deg = 1.0);

/// A small octahedron about each point.
/// @param size  from tip to tip [m]
Surface dots(const Points& points, double size);

}  // namespace palpate::render
