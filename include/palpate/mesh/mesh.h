#pragma once
#include <string>
#include <vector>

#include "palpate/core/types.h"

namespace palpate {

/// Tetrahedral mesh: every node is used, every volume is positive (tet_checks.h ensures it or throws).
struct TetMesh {
  Points nodes;  ///< rest positions [m]
  Tets tets;     ///< nodes of each tetrahedron
};

/// Triangle surface; closed and oriented outwards if it is the boundary of a body.
struct TriMesh {
  Points vertices;  ///< [m]
  Faces faces;      ///< vertices of each triangle
};

}  // namespace palpate
