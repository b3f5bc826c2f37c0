#pragma once
#include "shapes/shapes.h"

namespace palpate::shapes {

/// Distance to a standing person of 1.75 m, symmetric about x = 0, feet on z = 0 [m].
/// @param fine  true: with fingers, toes, face, muscles; false: boundary of the tetrahedra
double human(const Vec3& place, bool fine);
/// Makes the standing person, with a skeleton of 19 bones.
Shape make_human(const Resolution& resolution);

}  // namespace palpate::shapes
