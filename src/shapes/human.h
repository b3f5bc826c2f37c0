#pragma once
#include "palpate/shapes/shapes.h"

namespace palpate::shapes {

/// A standing person, 1.75 m, mirror image of itself about x = 0; feet on z = 0.  @param fine  with fingers,
/// toes, face, muscles; else what bounds the tetrahedra
double human(const Vec3& place, bool fine);
Shape make_human(const Resolution& resolution);

}  // namespace palpate::shapes
