#include "palpate/core/pose.h"

#include <cmath>

namespace palpate {
namespace {

/// Below this angle the first term of the series is exact to rounding, and the square of a component may
/// underflow.
constexpr double kTinyAngle = 1e-8;

/// Whether q is the representative of {q, -q}: w > 0, or at w = 0 (180 degrees) the first non-zero component
/// is positive.
bool is_canonical(const Quat& q) {
  if (q.w() != 0.0) return q.w() > 0.0;
  for (int i = 0; i < 3; ++i)
    if (q.vec()[i] != 0.0) return q.vec()[i] > 0.0;
  return true;
}

}  // namespace

// q = (cos(a/2), sin(a/2) n): with w >= 0, a = 2 atan2(|v|, w) is in [0, pi] and accurate at both ends,
// unlike acos and asin.
Vec3 rotation_vector(const Quat& q) {
  const double sign = is_canonical(q) ? 1.0 : -1.0;
  const Vec3 v = sign * q.vec();
  const double w = std::abs(q.w()), s = v.norm();
  const double angle_per_s = s < kTinyAngle ? 2.0 / w : 2.0 * std::atan2(s, w) / s;
  return angle_per_s * v;
}

Quat quaternion_of(const Vec3& rotation_vector) {
  const double angle = rotation_vector.norm();
  const double s = angle < kTinyAngle ? 0.5 : std::sin(0.5 * angle) / angle;
  const Vec3 v = s * rotation_vector;
  return {std::cos(0.5 * angle), v.x(), v.y(), v.z()};
}

Vec6 pose_difference(const Pose& from, const Pose& to) {
  Vec6 out;
  out.head<3>() = rotation_vector(to.rotation * from.rotation.conjugate());
  out.tail<3>() = to.translation - from.translation;
  return out;
}

}  // namespace palpate
