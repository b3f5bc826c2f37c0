#pragma once
#include "shapes/shapes.h"

namespace palpate::shapes {

/// Makes a pumpkin, 0.30 m across, with 12 ribs and a stem.
Shape make_pumpkin(const Resolution& resolution);

}  // namespace palpate::shapes
