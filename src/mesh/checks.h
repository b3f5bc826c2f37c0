#pragma once
#include <string>
#include <vector>

#include "palpate/mesh/mesh.h"
#include "palpate/mesh/source.h"

namespace palpate::mesh {

/// Origin of the entries of a mesh, so that a message can refer to `liver.msh:812: element 305`.  The lists
/// are as long as the mesh, or empty (a generator, a binary file): then entries are numbered from zero.
struct Provenance {
  std::string source;       ///< file name, or `generator "ball"`
  std::string node_source;  ///< file of the nodes, if separate (TetGen)
  std::string node_noun = "node", element_noun = "element";
  std::vector<long> node_number, element_number;  ///< numbers in the file
  std::vector<int> node_line, element_line;

  std::string node(int i) const;       ///< `FILE:LINE: node 12`
  std::string element(int e) const;    ///< `FILE:LINE: element 305`
  std::string node_name(int i) const;  ///< `node 12`, for the middle of a message
};
Provenance surface_provenance(std::string source);  ///< uses the nouns "vertex" and "face"

/// A tetrahedron is degenerate if its relative volume 6 sqrt(2) |V| / (longest edge)^3, which is 1 for the
/// regular tetrahedron, is at most this bound, or at most the rounding error of its coordinates.  A sliver
/// with dihedral angles of 0.1 degree has about 2e-3 and is accepted.
inline constexpr double kDegenerateTet = 1e-9;
/// A triangle is degenerate if 2 |A| / (longest edge)^2 is at most this bound.
inline constexpr double kDegenerateTriangle = 1e-9;

/// Reorders the nodes of elements of negative volume, and rejects meshes that cannot be simulated: no
/// elements, non-finite coordinates, degenerate or duplicate elements, three elements on one face,
/// unreferenced nodes.
/// @pre every index in mesh.tets lies in [0, number of nodes).
/// @throws Error with the place of the first defect
MeshReport check_tets(TetMesh& mesh, const Provenance& from);

/// Checks the boundary surface of a body: closed (each edge in exactly two faces), consistently oriented
/// (corrected by walking from face to face), outwards (inwards around a cavity), without degenerate or
/// duplicate faces or unreferenced vertices.  Leaves MeshReport.smallest_dihedral_deg at its default.
/// @throws Error with the place of the first defect
MeshReport check_surface(TriMesh& mesh, const Provenance& from);

}  // namespace palpate::mesh
