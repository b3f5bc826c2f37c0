#pragma once
#include "palpate/shapes/shapes.h"

namespace palpate::shapes {

Shape make_ball(const Resolution& resolution);

}  // namespace palpate::shapes
