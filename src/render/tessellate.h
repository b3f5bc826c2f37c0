#pragma once
#include <vector>

#include "corners.h"

namespace palpate::render {

/// Projection of positions to pixels.
struct Viewport {
  Eigen::Matrix4f view_projection;  ///< From positions of corners to clip coordinates.
  int width = 0, height = 0;        ///< Size of the image [pixels].
};

/// Returns the corners of triangles small enough to look smooth: each triangle is replaced by n^2 triangles
/// of a curved patch through its corners with their normals (point-normal triangle: Vlachos, Peters, Boyd and
/// Mitchell 2001). n is the least number, at most 12, for which most edges leave their curve by less than a
/// tenth of a pixel; it is the same for all triangles, so that no gaps open. Creases and flat surfaces stay
/// as they are, and so does a surface whose triangles are small.
/// @param corners  three per face (corners.h)
/// @param faces    their points
std::vector<Corner> tessellated(std::vector<Corner> corners, const Faces& faces, const Viewport& viewport);

}  // namespace palpate::render
