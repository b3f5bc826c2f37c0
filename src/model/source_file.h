#pragma once
#include <string>
#include <vector>

#include "mesh/polygon.h"
#include "mesh/provenance.h"
#include "palpate/mesh/mesh.h"
#include "palpate/mesh/regions.h"

namespace palpate::model {

/// Content of a user's file as read, before any check or repair.
struct SourceFile {
  TriMesh
      surface;  ///< triangles; larger polygons are cut (mesh/polygon.h).  Empty where there are tetrahedra.
  TetMesh tets;
  std::vector<MaterialRegion> regions;  ///< regions of the tetrahedra
  mesh::Provenance from;                ///< provenance of the surface or the tetrahedra
  mesh::PolygonReport polygons;         ///< report on the surface's polygons
  std::string format;                   ///< "Wavefront OBJ", "Gmsh 4.1", ...
};

}  // namespace palpate::model
