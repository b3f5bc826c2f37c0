#pragma once
#include <string>
#include <vector>

#include "source_file.h"

namespace palpate::model {

/// Reads a surface or tetrahedra; the ending of the file selects the format:
///   .obj                       Wavefront
///   .msh                       Gmsh 2.2 and 4.1 ASCII by palpate's reader; 1, 2.x and 4.x binary by libgmsh
///   .node .ele                 TetGen
///   .mesh                      Medit ASCII, by libgmsh
///   .meshb                     Medit binary, versions 1 to 4
///   .ply .off .stl             by CGAL
///   .vtk                       legacy VTK, versions up to 5.1, ASCII or binary
///   .vtu .vtp                  VTK XML: ASCII, base64 or raw, compressed by zlib or not
///   .h5                        palpate HDF5
/// Regions of tetrahedra are kept: Gmsh's physical volumes by their names (its volumes if there are none),
/// Medit's references, TetGen's attributes, a VTK cell array named in known_region_arrays(), palpate's
/// regions; numbers become "region-NUMBER".  libgmsh is loaded at the first file that needs it.  Only linear
/// triangles and tetrahedra are read; quadrangles and polygons are cut into triangles.
/// @throws Error with the file, and the line if the format has lines
SourceFile read_source(const std::string& path);

/// Returns the names of numeric VTK cell arrays that are read as regions, in order of preference and compared
/// without case: the names that Gmsh, meshio, Medit's converters and finite-element codes write.
const std::vector<std::string>& known_region_arrays();

/// Returns the endings that are read, separated by blanks, for messages.
std::string known_endings();

}  // namespace palpate::model
