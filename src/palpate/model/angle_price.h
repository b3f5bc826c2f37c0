#pragma once
#include <string>

#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// What bad angles cost a simulation, for the isotropic linear material below, beside good tetrahedra: those
/// of a box of cubes cut in five (smallest dihedral angle 54.7 degrees), of the same mean volume.
struct AnglePrice {
  static constexpr double kYoungsModulus = 1e4;   ///< [Pa]
  static constexpr double kPoissonsRatio = 0.45;  ///< -
  static constexpr double kDensity = 1000.0;      ///< [kg/m^3]
  static constexpr double kImplicitStep = 1e-3;   ///< [s]

  double bound_deg = 0.0;  ///< below it angles count as bad
  int bad = 0, all = 0;    ///< tetrahedra
  /// 2 / sqrt(largest eigenvalue of M^-1 K), M lumped: with longer steps central differences and symplectic
  /// Euler grow without bound
  double explicit_step_s = 0.0, good_explicit_step_s = 0.0;
  /// of M^-1 (M + h^2 K), h = kImplicitStep, for a body that nothing holds: 1 + h^2 (largest eigenvalue)
  double condition = 1.0, good_condition = 1.0;
};

/// @pre tetrahedra of positive volume
AnglePrice price_of_angles(const TetMesh& mesh, double bound_deg);

/// The largest eigenvalue of M^-1 K [1/s^2] of that material, by 60 steps of the Lanczos method from a fixed
/// start: from below, to a few per cent or better.
double largest_eigenvalue(const TetMesh& mesh);

/// One sentence.  It also says by how much the condition number of a static solve grows: as the largest
/// eigenvalue does, because the smallest ones are those of smooth modes, which hardly see single elements.
std::string text(const AnglePrice& price);

}  // namespace palpate::model
