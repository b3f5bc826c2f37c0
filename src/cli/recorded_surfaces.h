#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "palpate/loop/world.h"
#include "palpate/store/run_file.h"
#include "store/surface_files.h"

namespace palpate::cli {

/// The surfaces of a run that is over, at the states that it recorded: skins of bodies where the scene has
/// them, else the boundaries of their tetrahedra; bones and tools as they are.
class RecordedSurfaces {
 public:
  /// @param parts  of the run, by number
  /// @param skins  false: boundaries of tetrahedra only, for which the run file suffices; true: the scene of
  ///   the run is assembled
  /// @throws Error where the scene cannot be assembled, or makes other meshes than the run had
  RecordedSurfaces(const store::RunReader& run, const std::string& run_file, const std::vector<int>& parts,
                   bool skins);

  /// Colours bodies by displacement, from zero to `largest` [m]; what is rigid is plain.
  std::vector<store::SurfaceState> at(int step, double largest) const;
  std::size_t size() const { return surfaces_.size(); }
  bool rigid(std::size_t i) const { return surfaces_[i].rigid; }
  store::Rgb8 colour(std::size_t i) const;  ///< where it is plain
  /// Largest displacement of a node of a body at these steps [m]; zero where it is rounding.
  double largest_displacement(const std::vector<int>& steps) const;

 private:
  struct Surface {
    int part = 0;
    bool rigid = false;
    Faces faces;
    std::function<Points(const Points&)> points;  ///< of its vertices, from those of the part
    std::function<VecX(const VecX&)> values;      ///< likewise
    Points rest;                                  ///< of its vertices at the start
  };
  void add(int part, const loop::Body* body);

  const store::RunReader& run_;
  std::unique_ptr<loop::World> world_;  ///< null without skins
  std::vector<Surface> surfaces_;
};

}  // namespace palpate::cli
