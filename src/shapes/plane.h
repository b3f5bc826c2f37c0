#pragma once
#include "gear_profile.h"
#include "palpate/mesh/mesh.h"

namespace palpate::shapes {

/// Triangulates a plane region between an outer loop (counter-clockwise) and a hole (also counter-clockwise),
/// at z = 0, facing up.  Vertices: the outer loop, the hole, then `inside_vertices` interior ones.
/// @pre the segment from outer[0] to hole[0] lies in the region
TriMesh between(const std::vector<Point2>& outer, const std::vector<Point2>& hole, int inside_vertices);

/// Returns the number of interior vertices that makes triangles of the given edge length.
int vertices_between(const std::vector<Point2>& outer, const std::vector<Point2>& hole, double edge);

}  // namespace palpate::shapes
