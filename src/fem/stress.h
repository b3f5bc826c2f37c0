#pragma once
#include "element_chunks.h"
#include "law.h"

namespace palpate::fem {

/// Von Mises norm of the Cauchy stress P F^T / det F [Pa] of a first Piola-Kirchhoff stress P.
/// det F is taken as at least 0.1: a picture of a flat or inverted element shows a large stress, not an
/// infinite one.
double von_mises(const Mat3& P, const Mat3& F);

/// Von Mises norm of the Cauchy stress of each element, averaged to the nodes by volume [Pa].
/// Where materials meet, the average is over both: a stress that jumps there is smeared over
/// one element.
/// @param models  of the elements' materials: mu and lambda
VecX nodal_von_mises(const ElementChunks& elements, const double* x, const Law& law,
                     const std::vector<ElementModel>& models);

}  // namespace palpate::fem
