#pragma once
#include <string>
#include <vector>

#include "palpate/mesh/mesh.h"
#include "palpate/mesh/source.h"

namespace palpate::mesh {

/// Where the entries of a mesh came from, so that a message can say `liver.msh:812: element 305`. The lists
/// are as long as the mesh, or empty (a generator, a binary file): then entries are numbered from zero.
struct Provenance {
  std::string source;       ///< file name, or `generator "ball"`
  std::string node_source;  ///< where nodes have a file of their own (TetGen)
  std::string node_noun = "node", element_noun = "element";
  std::vector<long> node_number, element_number;  ///< the number that the file gives it
  std::vector<int> node_line, element_line;

  std::string node(int i) const;       ///< `FILE:LINE: node 12`
  std::string element(int e) const;    ///< `FILE:LINE: element 305`
  std::string node_name(int i) const;  ///< `node 12`, for the middle of a message
};
Provenance surface_provenance(std::string source);  ///< says "vertex" and "face"

/// A tetrahedron is degenerate when 6 sqrt(2) |V| / (longest edge)^3, which is 1 for the regular one, is not
/// above this bound, or not above what rounding of its coordinates makes of a flat one.  A sliver with
/// dihedral angles of 0.1 degree has about 2e-3: kept.
inline constexpr double kDegenerateTet = 1e-9;
/// A triangle is degenerate when 2 |A| / (longest edge)^2 is not above this bound.
inline constexpr double kDegenerateTriangle = 1e-9;

/// Reorders the nodes of elements of negative volume, and refuses (palpate::Error) meshes that no simulation
/// can use: no elements, non-finite coordinates, degenerate or duplicate elements, three elements on one
/// face, unreferenced nodes.
/// @pre every index in mesh.tets lies in [0, number of nodes).
MeshReport check_tets(TetMesh& mesh, const Provenance& from);

/// Checks a surface that bounds a body: closed (each edge in exactly two faces), consistently oriented
/// (mended by walking from face to face), outwards (inwards around a cavity), without degenerate or duplicate
/// faces or unreferenced vertices. Leaves MeshReport.smallest_dihedral_deg at its default.
MeshReport check_surface(TriMesh& mesh, const Provenance& from);

}  // namespace palpate::mesh
