#pragma once
#include <vector>

#include "palpate/render/scene.h"

namespace palpate::render {

/// What the GPU takes for one corner of a triangle.
struct Corner {
  /// value: 0 at the scale's low end, 1 at its high end; below -1: plain
  float position[3], normal[3], value;
};

/// Three corners a face.  A corner's normal is the area-weighted mean over the faces around its point that
/// lie within the crease angle of its own face: smooth where the surface is, sharp at edges.
/// @param origin  subtracted from the positions, so that float holds them
std::vector<Corner> corners(const Surface& surface, const ColourScale& scale, const Vec3& origin);

}  // namespace palpate::render
