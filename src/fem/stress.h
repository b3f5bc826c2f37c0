#pragma once
#include "corotated.h"
#include "element_chunks.h"

namespace palpate::fem {

/// Von Mises norm of the Cauchy stress P F^T / det F [Pa]; `tension` p adds p R to P.
double von_mises(const Mat3& F, const Lame& lame, double tension = 0.0);

/// Von Mises norm of the Cauchy stress of each element, averaged to the nodes by volume [Pa].
/// det F is taken as at least kSmallestDet: a picture of a flat or inverted element shows a large stress, not an infinite one.
VecX nodal_von_mises(const ElementChunks& elements, const double* x, const Lame& lame);

}  // namespace palpate::fem
