#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::mesh {

/// Boundary of a tetrahedral mesh: the faces that belong to one tetrahedron, oriented outwards.
struct Boundary {
  std::vector<int> node_of_vertex;  ///< boundary vertex -> node
  TriMesh surface;                  ///< at the rest positions
  std::vector<int> tet_of_face;     ///< tetrahedron behind each triangle
};
/// Extracts the boundary: its triangles in the order of the tetrahedra, its vertices in the order of the
/// nodes.
Boundary boundary(const TetMesh& mesh);

/// Returns the volume enclosed by a closed surface [m^3] (divergence theorem).
double enclosed_volume(const TriMesh& surface);

/// Returns the winding number of the closed shell of these faces about p: +-1 inside, 0 outside.
double winding_number(const TriMesh& surface, const std::vector<int>& faces, const Vec3& p);

}  // namespace palpate::mesh
