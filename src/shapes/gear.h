#pragma once
#include "gear_profile.h"
#include "shapes/shapes.h"

namespace palpate::shapes {

/// Makes a spur gear, 0.10 m across, with 23 involute teeth.
Shape make_gear(const Resolution& resolution);

}  // namespace palpate::shapes
