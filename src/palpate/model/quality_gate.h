#pragma once
#include <string>

#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// What a simulation asks of its tetrahedra.
struct TetQuality {
  int nodes = 0, tetrahedra = 0;
  double smallest_dihedral_deg = 180.0, largest_dihedral_deg = 0.0;
  int worst_tet = -1;  ///< with the smallest dihedral angle
  /// longest edge / (2 sqrt(6) x radius of the inscribed ball): 1 for the regular tetrahedron
  double worst_aspect = 1.0;
  double volume = 0.0;          ///< [m^3]
  double surface_volume = 0.0;  ///< enclosed by the surface that was meshed [m^3]
  double volume_error = 0.0;    ///< |volume / surface_volume - 1|
  double mean_edge = 0.0;       ///< [m]
};
TetQuality measure_quality(const TetMesh& mesh, double surface_volume);

struct QualityGate {
  double smallest_dihedral_deg = 8.0;
  double volume_error = 0.01;
  bool given = false;  ///< the tetrahedra are of a file: the refusal says how to fill their boundary anew
};
inline constexpr double kSharpDihedralDeg = 4.0;  ///< where creases are kept: their own angles may be small

/// Refuses a bad mesh, with the element, its place, and what to do.
/// @param surface  that was filled: a wrong volume is reported with the vertex farthest from all nodes
/// @throws Error
void pass_gate(const TetMesh& mesh, const TetQuality& quality, const QualityGate& gate,
               const std::string& source, const TriMesh& surface = {});

/// Refuses tetrahedra that share a face and lie on the same side of it: one of them is inside out.
/// @pre all have positive volumes (mesh::check_tets)
/// @throws Error with their numbers and the place
void check_sides(const TetMesh& mesh, const std::string& source);

}  // namespace palpate::model
