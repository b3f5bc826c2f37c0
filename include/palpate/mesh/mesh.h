#pragma once
#include <string>
#include <vector>

#include "palpate/core/types.h"

namespace palpate {

/// Tetrahedra: every node is used, every volume is positive (checks.h makes it so or refuses).
struct TetMesh {
  Points nodes;  ///< rest positions [m]
  Tets tets;     ///< nodes of each tetrahedron
};

/// A triangle surface; closed and oriented outwards where it bounds a body.
struct TriMesh {
  Points vertices;  ///< [m]
  Faces faces;      ///< vertices of each triangle
};

}  // namespace palpate
