#pragma once
#include <optional>
#include <string>
#include <vector>

#include "fit_volume.h"
#include "palpate/model/tetrahedralise.h"

namespace palpate::model {

struct CellCount {
  int tetrahedra = 0, nodes = 0;
  double mean_edge = 0.0;  ///< [m]
};

/// A stage of optimisation failed, and is left out from now on: the mesh is to be refined again.
struct OptimisationFailed {};

/// What the search asks of a mesher: refine() as often as it likes, then optimise() and take() the last one.
class CellMesher : public SurfaceQuery {
 public:
  /// bounds on circumradii, in the body and on its surface [m]
  virtual CellCount refine(double cell_size, double facet_size, const Progress& progress) = 0;
  virtual void optimise(const Progress& progress) = 0;  ///< @throws OptimisationFailed
  virtual FittedMesh take() = 0;
  virtual double thickness() const { return 0.0; }               ///< of the body, about [m]; 0: not known
  virtual std::vector<std::string> notes() const { return {}; }  ///< what had to be given up, for the outcome
};

/// What is filled, for guesses of what a size of elements makes of it.
struct BodySize {
  double volume = 0.0, area = 0.0;  ///< [m^3], [m^2]; about
  /// Vertices by bounds on circumradii [m]: some five cells a cube of that size and five cells a vertex, and
  /// a vertex for each half of a square of the facets'.
  double points(double cell_size, double facet_size) const {
    return volume / (cell_size * cell_size * cell_size) + 2.0 * area / (facet_size * facet_size);
  }

  /// Twice the volume over the area: the thickness of a sheet, somewhat less of what has sides too [m].
  double thickness() const { return area > 0 ? 2 * volume / area : 0.0; }
};

/// Refuses a sheet that is so thin for its extent that it takes many more tetrahedra than are wanted:
/// refinement would go on until the budget is spent.
/// @throws Error with about the number that it takes
void refuse_too_thin(const BodySize& size, const Vec3& place, const TetrahedraOptions& options);

/// Searches the cell size for the wanted number or edge length (and the facets' size for the wanted number of
/// nodes), optimises, and fits the boundary.
/// @param volume  of the inside, exactly or nearly [m^3]  @param exact  true: the mesh is fitted to it
/// @throws Error when the wanted number cannot be met within 3 %
Tetrahedra search_cells(CellMesher& mesher, double volume, bool exact, const TetrahedraOptions& options,
                        const Progress& progress);

}  // namespace palpate::model
