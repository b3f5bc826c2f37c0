#pragma once
#include <string>
#include <vector>

#include "palpate/mesh/checks.h"
#include "palpate/mesh/regions.h"
#include "palpate/mesh/skeleton.h"

namespace palpate::model {

/// What a region of tetrahedra is asked to fill: a closed surface, or the bones of the model.
struct RegionSource {
  std::string name;
  bool skeleton = false;  ///< the bones; else the surface
  TriMesh surface;        ///< of a file, as it stands there: is mended first
  mesh::Provenance from;
};

/// How well a region of whole tetrahedra fills what was asked for.
struct RegionFigures {
  std::string name;
  int tetrahedra = 0;
  double volume = 0.0;  ///< of its tetrahedra [m^3]
  /// enclosed by the surface that it was asked to fill [m^3]; 0: it comes from a file of tetrahedra, or from
  /// bones
  double surface_volume = 0.0;
};

/// For each point whether a closed surface that does not meet itself holds it.
std::vector<char> inside_of(const TriMesh& surface, const Points& points);

/// The tetrahedra whose middle lies in what each source asks for, beside the regions that are there already;
/// one that lies in several sources belongs to the last, and leaves the regions that are there. The border of
/// a region runs along faces of tetrahedra, so that its shape is right to an element: the finer, the better.
/// @param surface_volumes  of each source, 0 for bones
/// @throws Error for a source that holds the middle of none, for a name twice, for a surface that cannot be
///   mended
std::vector<MaterialRegion> add_regions(const TetMesh& tets, const Skeleton& skeleton,
                                        std::vector<MaterialRegion> regions,
                                        const std::vector<RegionSource>& sources,
                                        std::vector<double>& surface_volumes);

/// Regions of tetrahedra that are filled anew: each new one takes the regions of the old one that holds its
/// middle.
std::vector<MaterialRegion> carried_over(const TetMesh& old, const std::vector<MaterialRegion>& regions,
                                         const TetMesh& tets);

}  // namespace palpate::model
