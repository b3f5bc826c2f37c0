#pragma once
#include <string>

#include "palpate/mesh/mesh.h"
#include "palpate/mesh/regions.h"
#include "palpate/mesh/spec.h"

namespace palpate::mesh {

/// Report of a mesh check: what it changed or found.
struct MeshReport {
  int nodes = 0, elements = 0;                     ///< of the mesh as it is used
  int flipped = 0;                                 ///< elements whose orientation was mended
  double volume = 0.0;                             ///< [m^3]
  double smallest_dihedral_deg = 180.0;            ///< between two faces of one tetrahedron
  double largest_edge = 0.0, smallest_edge = 0.0;  ///< [m]
};

/// Reads or generates the tetrahedra of a spec, checked: volumes positive (orientation mended and reported),
/// no degenerate, duplicate, unreferenced or non-finite entries (refused, with file, element and value).
/// `folder`: where a relative file starts.  Formats by ending: .msh (Gmsh 2.2, 4.1 ASCII), .node/.ele
/// (TetGen); .h5 is read by store/mesh_file.h.
/// @param regions  of the file, if wanted; a generator has none
/// @param spec  what to read or generate  @param folder  see above  @param report  what was found, if wanted
TetMesh tet_mesh(const MeshSpec& spec, const std::string& folder, MeshReport* report = nullptr,
                 std::vector<MaterialRegion>* regions = nullptr);

/// Reads or generates a surface: .obj, or a generator ("ball", "box", "cylinder"), closed and oriented
/// outwards.
TriMesh surface(const MeshSpec& spec, const std::string& folder, MeshReport* report = nullptr);

}  // namespace palpate::mesh
