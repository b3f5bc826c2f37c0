#pragma once
#include <string>

#include "palpate/mesh/checks.h"
#include "palpate/mesh/polygon.h"
#include "palpate/mesh/regions.h"

/// File formats.  Each reader gives indices within range and finite coordinates, or throws Error `FILE:LINE:
/// ...`; it judges no geometry.
namespace palpate::mesh {

struct TetFile {
  TetMesh mesh;
  Provenance from;
  std::vector<MaterialRegion> regions;
};
/// .msh, ASCII, versions 2.0 to 2.2 and 4.1; tetrahedra only, other elements are passed over.  Regions:
/// physical volumes, which may overlap; where the file has none, the model's
/// volumes, if there are several.
TetFile read_gmsh(const std::string& path);
/// .node and .ele of the same stem; `path` names either.
/// Regions: the attribute of the tetrahedra, where it has several values.
TetFile read_tetgen(const std::string& path);

struct SurfaceFile {
  TriMesh mesh;
  Provenance from;
  PolygonReport polygons;
};
SurfaceFile read_obj(const std::string& path);  ///< v and f; polygons are cut into triangles

}  // namespace palpate::mesh
