#pragma once
#include <optional>
#include <string>
#include <vector>

#include "fit_volume.h"
#include "model/tetrahedralise.h"

namespace palpate::model {

/// Counts and mean edge length of a mesh.
struct CellCount {
  int tetrahedra = 0, nodes = 0;
  double mean_edge = 0.0;  ///< [m]
};

/// Exception: a stage of optimisation failed and is skipped from now on; the mesh must be refined again.
struct OptimisationFailed {};

/// Interface of the mesher that the search drives: refine() any number of times, then optimise() and take().
class CellMesher : public SurfaceQuery {
 public:
  /// Makes a new mesh.
  /// @param cell_size, facet_size  bounds on circumradii in the body and on its surface [m]
  virtual CellCount refine(double cell_size, double facet_size, const Progress& progress) = 0;
  virtual void optimise(const Progress& progress) = 0;  ///< @throws OptimisationFailed
  virtual FittedMesh take() = 0;
  virtual double thickness() const { return 0.0; }  ///< approximate thickness of the body [m]; 0: unknown
  virtual std::vector<std::string> notes() const {
    return {};
  }  ///< fallbacks that were taken, for the
     ///< record
};

/// Size of the body, from which the number of elements is estimated.
struct BodySize {
  double volume = 0.0, area = 0.0;  ///< approximate [m^3], [m^2]
  /// Estimates the number of vertices from the bounds on circumradii [m]: about five cells per cube of edge
  /// cell_size, five cells per vertex, and two vertices per square of edge facet_size.
  double points(double cell_size, double facet_size) const {
    return volume / (cell_size * cell_size * cell_size) + 2.0 * area / (facet_size * facet_size);
  }

  /// Returns twice the volume over the area [m]: the thickness of a sheet, and somewhat less for a body with
  /// lateral faces.
  double thickness() const { return area > 0 ? 2 * volume / area : 0.0; }
};

/// Rejects a sheet so thin for its extent that it needs many more tetrahedra than the target, on which
/// refinement would spend the whole budget.
/// @throws Error with the approximate number that it needs
void refuse_too_thin(const BodySize& size, const Vec3& place, const TetrahedraOptions& options);

/// Searches the cell size for the target number or edge length (and the facet size for the target number of
/// nodes), optimises the mesh, and fits its boundary.
/// @param volume  volume of the inside, exact or approximate [m^3]
/// @param exact   true: the mesh is fitted to that volume
/// @throws Error when the target cannot be met within 3 %
Tetrahedra search_cells(CellMesher& mesher, double volume, bool exact, const TetrahedraOptions& options,
                        const Progress& progress);

}  // namespace palpate::model
