#pragma once
#include "palpate/core/types.h"

namespace palpate::shapes {

/// Returns a smooth random function of space: gradients drawn by an integer hash at the points of the unit
/// lattice, blended by 6 t^5 - 15 t^4 + 10 t^3 (Perlin 2002).  Values are about within [-1, 1], zero at
/// lattice points, with features of size 1, and the same on every machine.
double noise(const Vec3& p, unsigned seed = 0);

/// Returns the pseudo-random number in [0, 1) of an integer.
double chance(int i, unsigned seed = 0);

}  // namespace palpate::shapes
