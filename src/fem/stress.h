#pragma once
#include "lane_kernels.h"
#include "palpate/core/types.h"

namespace palpate::fem {

/// Returns the von Mises norm of the Cauchy stress P F^T / det F [Pa] of a first Piola-Kirchhoff stress P.
/// det F is taken as at least kSmallestStressDet.
double von_mises(const Mat3& P, const Mat3& F);

}  // namespace palpate::fem
