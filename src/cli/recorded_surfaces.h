#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "palpate/loop/world.h"
#include "palpate/store/run_file.h"
#include "store/surface_files.h"

namespace palpate::cli {

/// Surfaces of a finished run at its recorded states: skins of bodies that have one, boundaries of their
/// tetrahedra otherwise; bones and tools unchanged.
class RecordedSurfaces {
 public:
  /// @param parts  numbers of the parts of the run
  /// @param skins  false: boundaries of tetrahedra only, for which the run file suffices; true: the scene of
  /// the run is assembled
  /// @throws Error if the scene cannot be assembled, or its meshes differ from the meshes of the run
  RecordedSurfaces(const store::RunReader& run, const std::string& run_file, const std::vector<int>& parts,
                   bool skins);

  /// Returns the surfaces at a step. Bodies are coloured by displacement, from zero to `largest` [m]; rigid
  /// parts have a plain colour.
  std::vector<store::SurfaceState> at(int step, double largest) const;
  std::size_t size() const { return surfaces_.size(); }
  bool rigid(std::size_t i) const { return surfaces_[i].rigid; }
  store::Rgb8 colour(std::size_t i) const;  ///< Plain colour of surface i
  /// Returns the largest displacement of a node of a body at these steps [m]; zero if it is below rounding.
  double largest_displacement(const std::vector<int>& steps) const;

 private:
  struct Surface {
    int part = 0;
    bool rigid = false;
    Faces faces;
    std::function<Points(const Points&)> points;  ///< Maps positions of the nodes of the part to vertices
    std::function<VecX(const VecX&)> values;      ///< Maps nodal values of the part to vertices
    Points rest;                                  ///< Vertices at the start
  };
  void add(int part, const loop::Body* body);

  const store::RunReader& run_;
  std::unique_ptr<loop::World> world_;  ///< Null without skins
  std::vector<Surface> surfaces_;
};

}  // namespace palpate::cli
