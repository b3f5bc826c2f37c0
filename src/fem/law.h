#pragma once
#include "lane_kernels.h"
#include "palpate/core/types.h"
#include "palpate/fem/laws.h"
#include "palpate/fem/material.h"
#include "palpate/fem/options.h"

namespace palpate::fem {

/// A : B
inline double double_dot(const Mat3& A, const Mat3& B) { return A.cwiseProduct(B).sum(); }

/// A hyperelastic, isotropic law by its energy density Psi(F) of the deformation gradient F, one element at a
/// time.  These formulas are the reference; the ones in lanes (lanes_NAME.cpp) are the same in vector
/// registers. Every F is allowed, flat and inverted as well.  Lame's constants are those of linear elasticity
/// that the law agrees with at small strain.
struct Law {
  const char* summary;
  bool warped;            ///< has Tangent::kWarped
  bool nodal_dilatation;  ///< lambda acts by an energy of its own, which NodalDilatation can take over
  double (*energy_density)(const Mat3& F, const Lame& lame);  ///< Psi [J/m^3], zero at rest
  Mat3 (*stress)(const Mat3& F, const Lame& lame);  ///< first Piola-Kirchhoff stress P = dPsi/dF [Pa]
  /// dP of a direction dF with one of the tangents.
  Mat3 (*stress_change)(Tangent tangent, const Mat3& F, const Mat3& dF, const Lame& lame);
  ScalarPath scalar;  ///< what the law's kernels leave to scalar code
};

/// Place of the entry called `name` in law_registry(), and in LaneKernels::laws.
/// @throws Error naming the nearest known name; `where` begins the message
std::size_t find_law(const std::string& name, std::string_view where);

}  // namespace palpate::fem
