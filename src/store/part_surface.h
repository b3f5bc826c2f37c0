#pragma once
#include <vector>

#include "palpate/store/run_file.h"

namespace palpate::store {

/// Triangles by which a part of a run is displayed.
struct PartSurface {
  std::vector<int> node_of_vertex;  ///< Index of the part's point for each vertex.
  Faces faces;                      ///< Vertex indices, counter-clockwise seen from outside.
};

/// Returns the boundary of a body's tetrahedra, or a tool's triangles unchanged.
PartSurface part_surface(const RunPart& part);

}  // namespace palpate::store
