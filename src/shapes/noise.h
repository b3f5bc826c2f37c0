#pragma once
#include "palpate/core/types.h"

namespace palpate::shapes {

/// A smooth random function of space: gradients drawn by an integer hash at the points of the unit lattice,
/// blended by 6 t^5 - 15 t^4 + 10 t^3 (Perlin 2002). About within [-1, 1], zero at lattice points, features
/// of size 1, the same on every machine.
double noise(const Vec3& p, unsigned seed = 0);

/// A number in [0, 1) that belongs to an integer.
double chance(int i, unsigned seed = 0);

}  // namespace palpate::shapes
