#pragma once
#include "element_chunks.h"
#include "law.h"

namespace palpate::fem {

/// Returns the von Mises norm of the Cauchy stress P F^T / det F [Pa] of a first Piola-Kirchhoff stress P.
/// det F is taken as at least 0.1, so that pictures of flat or inverted elements show a large stress, not an
/// infinite one.
double von_mises(const Mat3& P, const Mat3& F);

/// Returns the von Mises norm of the Cauchy stress of each element, averaged to the nodes by volume [Pa].
/// Where materials meet, the average is over both: a stress that jumps there is smeared over one element.
/// @param elements, x  Elements of the body and its positions [m].
/// @param law  Constitutive law.
/// @param models  mu and lambda per material.
VecX nodal_von_mises(const ElementChunks& elements, const double* x, const Law& law,
                     const std::vector<ElementModel>& models);

}  // namespace palpate::fem
