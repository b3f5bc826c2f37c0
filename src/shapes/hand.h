#pragma once
#include "palpate/core/types.h"

namespace palpate::shapes {

/// Left hand and foot of the standing figure, metres, in its axes.  @param fine  fingers and toes apart; else
/// a mitten and a shoe, which bound them
double hand(const Vec3& p, bool fine);
double foot(const Vec3& p, bool fine);

}  // namespace palpate::shapes
