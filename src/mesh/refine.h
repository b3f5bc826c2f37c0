#pragma once
#include <array>
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::mesh {

/// Mesh of tetrahedra, each divided into eight.  Nodes of the coarse mesh keep their numbers; the midpoints
/// of its edges follow.
struct RefinedTets {
  TetMesh mesh;                           ///< children of element t: 8 t ... 8 t + 7
  std::vector<std::array<int, 2>> edges;  ///< ends of the edge whose midpoint each further node is
};

/// Divides each tetrahedron into eight of equal volume: four at its corners, and four around the shortest
/// diagonal of the octahedron between them, of which the first of equal ones is taken (Bey 1995, "Tetrahedral
/// grid refinement").  The shape of the body stays as it is.
/// @pre tetrahedra of positive volume (check_tets)
RefinedTets refine(const TetMesh& coarse);

/// Divides each triangle into four at the midpoints of its edges.  The shape of the surface stays as it is;
/// vertices keep their numbers, and midpoints follow.
TriMesh refine(const TriMesh& coarse);

}  // namespace palpate::mesh
