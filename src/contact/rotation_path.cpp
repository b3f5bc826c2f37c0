#include "contact/rotation_path.h"

#include <cmath>

namespace palpate::contact {

// With a = |phi|:  J = I + (1 - cos a)/a^2 [phi] + (a - sin a)/a^3 [phi]^2   (e.g. Bullo and Murray 1995).
// Below a = 1e-2 the coefficients' series to a^4 are exact to rounding, where the closed forms cancel.
Mat3 left_jacobian(const Vec3& phi) {
  const double a2 = phi.squaredNorm(), a = std::sqrt(a2);
  const bool small = a < 1e-2;
  const double b = small ? 0.5 - a2 / 24 + a2 * a2 / 720 : (1 - std::cos(a)) / a2;
  const double c = small ? 1.0 / 6 - a2 / 120 + a2 * a2 / 5040 : (a - std::sin(a)) / (a2 * a);
  const Mat3 P = cross_matrix(phi);
  return Mat3::Identity() + b * P + c * P * P;
}

// J^-1 = I - [phi]/2 + (1/a^2 - cot(a/2)/(2 a)) [phi]^2
Mat3 left_jacobian_inverse(const Vec3& phi) {
  const double a2 = phi.squaredNorm(), a = std::sqrt(a2);
  const double c = a < 1e-2 ? 1.0 / 12 + a2 / 720 + a2 * a2 / 30240 : 1 / a2 - 0.5 / (a * std::tan(0.5 * a));
  const Mat3 P = cross_matrix(phi);
  return Mat3::Identity() - 0.5 * P + c * P * P;
}

Cubic hermite(double s, const Vec3& x0, const Vec3& m0, const Vec3& x1, const Vec3& m1) {
  const double s2 = s * s, s3 = s2 * s;
  return {(2 * s3 - 3 * s2 + 1) * x0 + (s3 - 2 * s2 + s) * m0 + (3 * s2 - 2 * s3) * x1 + (s3 - s2) * m1,
          6 * (s2 - s) * (x0 - x1) + (3 * s2 - 4 * s + 1) * m0 + (3 * s2 - 2 * s) * m1};
}

}  // namespace palpate::contact
