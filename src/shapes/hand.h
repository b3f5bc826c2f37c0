#pragma once
#include "palpate/core/types.h"

namespace palpate::shapes {

/// Distance to the left hand and the left foot of the standing figure, in its axes [m].
/// @param fine  true: separate fingers and toes; false: a mitten and a shoe, for the boundary of the
///   tetrahedra
double hand(const Vec3& p, bool fine);
double foot(const Vec3& p, bool fine);

}  // namespace palpate::shapes
