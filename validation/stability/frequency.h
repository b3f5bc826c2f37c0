#pragma once
#include "palpate/dynamics/system.h"

namespace palpate::stability {

/// Returns the largest w of K phi = w^2 M phi at a state [rad/s]; dense, for small systems.
double largest_frequency(dynamics::System& system, const dynamics::StateView& state);

}  // namespace palpate::stability
