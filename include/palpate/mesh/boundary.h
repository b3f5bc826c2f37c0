#pragma once
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::mesh {

/// The boundary of a tetrahedral mesh: faces that belong to one tetrahedron, oriented outwards.
struct Boundary {
  std::vector<int> node_of_vertex;  ///< boundary vertex -> node
  TriMesh surface;                  ///< at the rest positions
  std::vector<int> tet_of_face;     ///< tetrahedron behind each triangle
};
/// The triangles that belong to one tetrahedron alone, outward, and the nodes on them.
Boundary boundary(const TetMesh& mesh);

/// Volume enclosed by a closed surface [m^3] (divergence theorem).
double enclosed_volume(const TriMesh& surface);

/// How often the closed shell made of these faces winds around p: +-1 inside, 0 outside.
double winding_number(const TriMesh& surface, const std::vector<int>& faces, const Vec3& p);

}  // namespace palpate::mesh
