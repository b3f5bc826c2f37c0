#pragma once
#include "lane_kernels.h"
#include "palpate/core/types.h"
#include "palpate/fem/material.h"
#include "palpate/fem/options.h"

namespace palpate::fem {

/// A : B
inline double double_dot(const Mat3& A, const Mat3& B) { return A.cwiseProduct(B).sum(); }

/// Hyperelastic, isotropic law given by its energy density Psi(F) of the deformation gradient F, one element
/// at a time. These formulas are the reference; lanes_NAME.cpp implements the same formulas in vector
/// registers. Every F is allowed, including flat and inverted elements. The Lame constants are those of
/// linear elasticity, with which the law agrees at small strain.
struct Law {
  const char* summary;
  bool warped;            ///< supports Tangent::kWarped
  bool nodal_dilatation;  ///< lambda acts by a separate energy term, which NodalDilatation can replace
  double (*energy_density)(const Mat3& F, const Lame& lame);  ///< Psi [J/m^3], zero at rest
  Mat3 (*stress)(const Mat3& F, const Lame& lame);  ///< first Piola-Kirchhoff stress P = dPsi/dF [Pa]
  /// Returns dP for a direction dF with one of the tangents.
  Mat3 (*stress_change)(Tangent tangent, const Mat3& F, const Mat3& dF, const Lame& lame);
  ScalarPath scalar;  ///< scalar fallback of the law's kernels
};

}  // namespace palpate::fem
