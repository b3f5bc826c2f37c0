#pragma once
#include "corotated.h"
#include "element_chunks.h"

namespace palpate::fem {

/// Von Mises norm of the Cauchy stress P F^T / det F [Pa]; `tension` p adds p R to P.
double von_mises(const Mat3& F, const Lame& lame, double tension = 0.0);

/// Von Mises norm of the Cauchy stress of each element, averaged to the nodes by volume [Pa].
/// det F is taken as at least kSmallestDet: a picture of a flat or inverted element shows a large stress, not
/// an infinite one. Where materials meet, the average is over both: a stress that jumps there is smeared over
/// one element.
/// @param models  of the elements' materials: mu and lambda
VecX nodal_von_mises(const ElementChunks& elements, const double* x, const std::vector<ElementModel>& models);

}  // namespace palpate::fem
