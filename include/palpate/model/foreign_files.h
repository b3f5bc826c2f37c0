#pragma once
#include <string>

#include "palpate/mesh/checks.h"
#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// What a person's file holds, as it stands in the file: nothing is judged or mended yet.
struct SourceFile {
  TriMesh surface;        ///< triangles; larger polygons are cut into fans.  Empty where there are tetrahedra.
  TetMesh tets;
  mesh::Provenance from;  ///< of the surface, or of the tetrahedra
  std::string format;     ///< "Wavefront OBJ", "Gmsh 4.1", ...
};

/// Reads a surface or tetrahedra, by the ending of the file:
///   .obj                       Wavefront
///   .msh                       Gmsh 2.2 and 4.1 ASCII by palpate's own reader; 1, 2.x and 4.x binary by libgmsh
///   .node .ele                 TetGen
///   .mesh .meshb .vtk .stl     Medit, legacy VTK, STL (ASCII or binary): by libgmsh
///   .ply .off                  by CGAL
///   .vtu                       VTK's XML: ASCII, base64 or raw, compressed by zlib or not
///   .h5                        palpate's own
/// libgmsh is loaded at the first file that needs it, and never otherwise.  Only linear triangles and tetrahedra are taken; quadrangles are cut in two.
/// @throws Error with the file, and the line where the format has lines
SourceFile read_source(const std::string& path);

/// Endings that are read, for messages.
std::string known_endings();

}  // namespace palpate::model
