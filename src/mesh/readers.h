#pragma once
#include <string>

#include "mesh/polygon.h"
#include "mesh/provenance.h"
#include "palpate/mesh/mesh.h"
#include "palpate/mesh/regions.h"

/// Readers of file formats.  Each returns indices within range and finite coordinates, or throws Error
/// `FILE:LINE: ...`; geometry is not checked.
namespace palpate::mesh {

/// Tetrahedra of a file, with their origin and regions.
struct TetFile {
  TetMesh mesh;
  Provenance from;
  std::vector<MaterialRegion> regions;
};
/// Reads .msh, ASCII, versions 2.0 to 2.2 and 4.1.  Tetrahedra only; other elements are skipped.  Regions are
/// the physical volumes, which may overlap; if the file has none, the model's volumes, if there are several.
TetFile read_gmsh(const std::string& path);
/// Reads .node and .ele of the same stem; `path` is either of them.  Regions are the values of the
/// tetrahedra's attribute, if there are several.
TetFile read_tetgen(const std::string& path);

/// Surface of a file, with its origin and a report on its polygons.
struct SurfaceFile {
  TriMesh mesh;
  Provenance from;
  PolygonReport polygons;
};
SurfaceFile read_obj(const std::string& path);  ///< reads v and f; polygons are cut into triangles

}  // namespace palpate::mesh
