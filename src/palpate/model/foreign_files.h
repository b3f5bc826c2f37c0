#pragma once
#include <string>

#include "palpate/mesh/checks.h"
#include "palpate/mesh/mesh.h"
#include "palpate/mesh/polygon.h"
#include "palpate/mesh/regions.h"

namespace palpate::model {

/// What a person's file holds, as it stands in the file: nothing is judged or mended yet.
struct SourceFile {
  TriMesh
      surface;  ///< triangles; larger polygons are cut (mesh/polygon.h).  Empty where there are tetrahedra.
  TetMesh tets;
  std::vector<MaterialRegion> regions;  ///< of the tetrahedra
  mesh::Provenance from;                ///< of the surface, or of the tetrahedra
  mesh::PolygonReport polygons;         ///< of the surface
  std::string format;                   ///< "Wavefront OBJ", "Gmsh 4.1", ...
};

/// Reads a surface or tetrahedra, by the ending of the file:
///   .obj                       Wavefront
///   .msh                       Gmsh 2.2 and 4.1 ASCII by palpate's own reader; 1, 2.x and 4.x binary by
///   libgmsh
///   .node .ele                 TetGen
///   .mesh                      Medit as text, by libgmsh
///   .meshb                     Medit's binary form, versions 1 to 4
///   .ply .off .stl             by CGAL
///   .vtk                       legacy VTK, versions up to 5.1, as text or bytes
///   .vtu .vtp                  VTK's XML: ASCII, base64 or raw, compressed by zlib or not
///   .h5                        palpate's own
/// Regions of tetrahedra are kept: Gmsh's physical volumes by their names (where there are none, its
/// volumes), references of Medit, attributes of TetGen, an array of VTK cells called as one of
/// known_region_arrays(), regions of palpate's own; numbers become "region-NUMBER". libgmsh is loaded at the
/// first file that needs it, and never otherwise.  Only linear triangles and tetrahedra are taken;
/// quadrangles and polygons are cut into triangles.
/// @throws Error with the file, and the line where the format has lines
SourceFile read_source(const std::string& path);

/// Names of arrays of numbers of VTK cells that are taken for regions, whatever the case of their letters,
/// the first that is there: as Gmsh, meshio, Medit's converters and finite-element codes write them.
const std::vector<std::string>& known_region_arrays();

/// Endings that are read, for messages.
std::string known_endings();

}  // namespace palpate::model
