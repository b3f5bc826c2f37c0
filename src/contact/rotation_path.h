#pragma once
#include "palpate/core/pose.h"

namespace palpate::contact {

/// w = J(phi) phi' is the world angular velocity of exp(phi(t)) q0 (the left Jacobian of SO(3)).
Mat3 left_jacobian(const Vec3& phi);
/// Its inverse, for |phi| < 2 pi.
Mat3 left_jacobian_inverse(const Vec3& phi);

/// Cubic Hermite interpolation on [0, 1]: value and derivative by s, from the end values and the end
/// derivatives by s.
struct Cubic {
  Vec3 value, slope;
};
Cubic hermite(double s, const Vec3& x0, const Vec3& m0, const Vec3& x1, const Vec3& m1);

}  // namespace palpate::contact
