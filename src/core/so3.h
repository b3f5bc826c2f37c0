#pragma once
#include "palpate/core/types.h"

namespace palpate {

/// Returns the left Jacobian J(theta) of a rotation vector theta [rad]: with R = exp(theta), the angular
/// velocity in world axes is omega = J(theta) theta'.
Mat3 left_jacobian(const Vec3& theta);

/// Returns J^-1 of a rotation vector, theta' = J^-1(theta) omega; |theta| < 2 pi.  J^-1(-theta) is its
/// transpose, and the right Jacobian's inverse.
Mat3 left_jacobian_inverse(const Vec3& theta);

}  // namespace palpate
