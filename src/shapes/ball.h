#pragma once
#include "shapes/shapes.h"

namespace palpate::shapes {

/// Makes a ball of radius 0.03 m.
Shape make_ball(const Resolution& resolution);

}  // namespace palpate::shapes
