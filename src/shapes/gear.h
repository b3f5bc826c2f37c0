#pragma once
#include "gear_profile.h"
#include "palpate/shapes/shapes.h"

namespace palpate::shapes {

Shape make_gear(const Resolution& resolution);

}  // namespace palpate::shapes
