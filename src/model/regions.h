#pragma once
#include <string>
#include <vector>

#include "mesh/provenance.h"
#include "palpate/mesh/regions.h"
#include "palpate/mesh/skeleton.h"

namespace palpate::model {

/// Shape that a region of tetrahedra fills: a closed surface, or the bones of the model.
struct RegionSource {
  std::string name;
  bool skeleton = false;  ///< true: the bones; false: the surface
  TriMesh surface;        ///< as read from the file; is mended first
  mesh::Provenance from;
};

/// Volumes of a region of whole tetrahedra and of the shape that it fills.
struct RegionFigures {
  std::string name;
  int tetrahedra = 0;
  double volume = 0.0;  ///< volume of its tetrahedra [m^3]
  /// Volume enclosed by the source's surface [m^3]; 0 for a region of a file of tetrahedra, or of bones.
  double surface_volume = 0.0;
};

/// Reports for each point whether a closed surface without self-intersections contains it.
std::vector<char> inside_of(const TriMesh& surface, const Points& points);

/// Adds for each source the region of tetrahedra whose centroids lie in it.  A tetrahedron in several sources
/// belongs to the last, and is removed from existing regions.  The border of a region follows faces of
/// tetrahedra, so that its shape is accurate to one element.
/// @param surface_volumes  set to one volume per source [m^3], 0 for bones
/// @throws Error for a source that contains no centroid, for a duplicate name, for a surface that cannot be
///   mended
std::vector<MaterialRegion> add_regions(const TetMesh& tets, const Skeleton& skeleton,
                                        std::vector<MaterialRegion> regions,
                                        const std::vector<RegionSource>& sources,
                                        std::vector<double>& surface_volumes);

/// Transfers regions to tetrahedra that were filled anew: each new tetrahedron takes the regions of the old
/// one that contains its centroid.
std::vector<MaterialRegion> carried_over(const TetMesh& old, const std::vector<MaterialRegion>& regions,
                                         const TetMesh& tets);

}  // namespace palpate::model
