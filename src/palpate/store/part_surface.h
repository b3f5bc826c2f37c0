#pragma once
#include <vector>

#include "palpate/store/run_file.h"

namespace palpate::store {

/// The triangles that a part of a run shows.
struct PartSurface {
  std::vector<int> node_of_vertex;  ///< which of the part's points each vertex is
  Faces faces;                      ///< indices of vertices, counter-clockwise seen from outside
};

/// The boundary of a body's tetrahedra, or a tool's triangles as they are.
PartSurface part_surface(const RunPart& part);

}  // namespace palpate::store
