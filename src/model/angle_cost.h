#pragma once
#include <string>

#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// Cost of small dihedral angles for a simulation of the isotropic linear material below, relative to good
/// tetrahedra of the same mean volume: a box of cubes, each cut in five (smallest dihedral angle 54.7
/// degrees).
struct AngleCost {
  static constexpr double kYoungsModulus = 1e4;   ///< [Pa]
  static constexpr double kPoissonsRatio = 0.45;  ///< [-]
  static constexpr double kDensity = 1000.0;      ///< [kg/m^3]
  static constexpr double kImplicitStep = 1e-3;   ///< [s]

  double bound_deg = 0.0;  ///< angles below it count as bad
  int bad = 0, all = 0;    ///< number of tetrahedra with bad angles, and of all tetrahedra
  /// Stability limit 2 / sqrt(largest eigenvalue of M^-1 K), M lumped: with longer steps central differences
  /// and symplectic Euler grow without bound.
  double explicit_step_s = 0.0, good_explicit_step_s = 0.0;
  /// Condition number of M^-1 (M + h^2 K), h = kImplicitStep, for an unconstrained body: 1 + h^2 (largest
  /// eigenvalue).
  double condition = 1.0, good_condition = 1.0;
};

/// Computes stability limits and condition numbers of a mesh and of a good mesh.
/// @param bound_deg  angles below it count as bad
/// @pre tetrahedra of positive volume
AngleCost price_of_angles(const TetMesh& mesh, double bound_deg);

/// Returns the largest eigenvalue of M^-1 K [1/s^2] of that material, by at most 60 steps of the Lanczos
/// method from a fixed start: a lower bound, accurate to a few per cent or better.
double largest_eigenvalue(const TetMesh& mesh);

/// Returns the cost as one sentence.  It includes the factor on the condition number of a static solve, which
/// grows as the largest eigenvalue does: the smallest eigenvalues belong to smooth modes, which single
/// elements hardly affect.
std::string text(const AngleCost& cost);

}  // namespace palpate::model
