#pragma once
#include <string>

#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// Quality of tetrahedra for simulation.
struct TetQuality {
  int nodes = 0, tetrahedra = 0;
  double smallest_dihedral_deg = 180.0, largest_dihedral_deg = 0.0;
  int worst_tet = -1;  ///< tetrahedron with the smallest dihedral angle
  /// Largest aspect ratio: longest edge / (2 sqrt(6) x radius of the inscribed ball); 1 for the regular
  /// tetrahedron.
  double worst_aspect = 1.0;
  double volume = 0.0;          ///< [m^3]
  double surface_volume = 0.0;  ///< enclosed by the surface that was meshed [m^3]
  double volume_error = 0.0;    ///< |volume / surface_volume - 1|
  double mean_edge = 0.0;       ///< [m]
};
/// Measures a mesh.
/// @param surface_volume  volume enclosed by the surface that was meshed [m^3]
TetQuality measure_quality(const TetMesh& mesh, double surface_volume);

/// Acceptance limits of `pass_gate`.
struct QualityGate {
  double smallest_dihedral_deg = 8.0;
  double volume_error = 0.01;
  bool given = false;  ///< true: tetrahedra of a file; the error message recommends filling their boundary
                       ///< anew
};
inline constexpr double kSharpDihedralDeg = 4.0;  ///< limit if creases are kept, whose angles may be small

/// Rejects a bad mesh with the element, its place, and a remedy.
/// @param surface  surface that was filled: a wrong volume is reported with its vertex farthest from all
///   nodes
/// @throws Error
void pass_gate(const TetMesh& mesh, const TetQuality& quality, const QualityGate& gate,
               const std::string& source, const TriMesh& surface = {});

/// Rejects tetrahedra that share a face and lie on the same side of it: one of them is inverted.
/// @pre all have positive volumes (mesh::check_tets)
/// @throws Error with their numbers and the place
void check_sides(const TetMesh& mesh, const std::string& source);

}  // namespace palpate::model
