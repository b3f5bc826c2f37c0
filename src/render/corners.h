#pragma once
#include <vector>

#include "render/scene.h"

namespace palpate::render {

/// Vertex data for one corner of a triangle, as sent to the GPU.
struct Corner {
  /// value: 0 at the scale's low end, 1 at its high end; below -1: plain colour.
  float position[3], normal[3], value;
};

/// Returns three corners per face.  The normal at a corner is the area-weighted mean over the faces around
/// its point whose normals are within the crease angle of its face: smooth where the surface is, sharp at
/// edges.
/// @param origin  subtracted from the positions to limit rounding in single precision
std::vector<Corner> corners(const Surface& surface, const ColourScale& scale, const Vec3& origin);

}  // namespace palpate::render
