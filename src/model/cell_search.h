#pragma once
#include <optional>
#include <string>

#include "fit_volume.h"
#include "palpate/model/tetrahedralise.h"

namespace palpate::model {

struct CellCount {
  int tetrahedra = 0, nodes = 0;
  double mean_edge = 0.0;  ///< [m]
};

/// What the search asks of a mesher: refine() as often as it likes, then optimise() and take() the last one.
class CellMesher : public SurfaceQuery {
 public:
  /// bounds on circumradii, in the body and on its surface [m]
  virtual CellCount refine(double cell_size, double facet_size) = 0;
  virtual void optimise(const Progress& progress) = 0;
  virtual FittedMesh take() = 0;
};

/// Searches the cell size for the wanted number or edge length (and the facets' size for the wanted number of
/// nodes), optimises, and fits the boundary.
/// @param volume  of the inside, exactly or nearly [m^3]  @param exact  true: the mesh is fitted to it
/// @throws Error when the wanted number cannot be met within 3 %
Tetrahedra search_cells(CellMesher& mesher, double volume, bool exact, const TetrahedraOptions& options,
                        const Progress& progress);

}  // namespace palpate::model
