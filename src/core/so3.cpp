#include "core/so3.h"

#include <cmath>

namespace palpate {
namespace {

/// Below this angle the closed forms lose digits to cancellation, and the series, truncated after a^8, are
/// exact to rounding.
constexpr double kSeriesAngle = 0.25;

}  // namespace

// Rodrigues' formula, exp(theta) = I + sin(a)/a [theta] + (1 - cos a)/a^2 [theta]^2, integrated over the
// angle (J = int_0^1 exp(s theta) ds):
//   J = I + (1 - cos a)/a^2 [theta] + (a - sin a)/a^3 [theta]^2,   a = |theta|.
Mat3 left_jacobian(const Vec3& theta) {
  const double a = theta.norm(), a2 = a * a;
  const double half = a < kSeriesAngle ? 1.0 : std::sin(0.5 * a) / (0.5 * a);
  double first = 0.5 * half * half, second = (a - std::sin(a)) / (a2 * a);
  if (a < kSeriesAngle) {
    first = 1.0 / 2 - a2 / 24 * (1.0 - a2 / 30 * (1.0 - a2 / 56 * (1.0 - a2 / 90)));
    second = 1.0 / 6 - a2 / 120 * (1.0 - a2 / 42 * (1.0 - a2 / 72 * (1.0 - a2 / 110)));
  }
  const Mat3 w = cross_matrix(theta);
  return Mat3::Identity() + first * w + second * w * w;
}

// With [theta]^3 = -a^2 [theta], J^-1 = I - 1/2 [theta] + c [theta]^2
// solves J J^-1 = I for c = (1 - (a/2) cot(a/2))/a^2.
Mat3 left_jacobian_inverse(const Vec3& theta) {
  const double a = theta.norm(), a2 = a * a;
  double c = 1.0 / 12 + a2 / 720 * (1.0 + a2 / 42 * (1.0 + a2 / 40 * (1.0 + a2 * 5.0 / 198)));
  if (a >= kSeriesAngle) c = (1.0 - 0.5 * a / std::tan(0.5 * a)) / a2;
  const Mat3 w = cross_matrix(theta);
  return Mat3::Identity() - 0.5 * w + c * w * w;
}

}  // namespace palpate
