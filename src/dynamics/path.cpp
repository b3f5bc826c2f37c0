#include "palpate/dynamics/path.h"

#include "core/so3.h"

namespace palpate::dynamics {
namespace {

/// Value and derivative at s in [0, 1] of the Hermite cubic through 0 and `end` with slopes `m0` and `m1`
/// with respect to s.
struct Cubic {
  Vec3 value, slope;
};
Cubic cubic(double s, const Vec3& end, const Vec3& m0, const Vec3& m1) {
  const double r = 1.0 - s;
  return {s * s * (3.0 - 2.0 * s) * end + s * r * r * m0 - s * s * r * m1,
          6.0 * s * r * end + r * (1.0 - 3.0 * s) * m0 + s * (3.0 * s - 2.0) * m1};
}

}  // namespace

// Rotation: theta(s) runs from 0 to d, the rotation vector of R1 R0^T, with R(s) = exp(theta) R0 and omega =
// J(theta) theta'/h. The slopes at the ends follow from the twists: h omega0 at s = 0 (J(0) = I) and h
// J^-1(d) omega1 at s = 1.
RigidMotion motion_between(const RigidMotion& from, const RigidMotion& to, double h, double s) {
  const Vec6 d = pose_difference(from.pose, to.pose);
  const Cubic rotation = cubic(s, d.head<3>(), h * from.twist.angular,
                               h * left_jacobian_inverse(d.head<3>()) * to.twist.angular);
  const Cubic shift = cubic(s, d.tail<3>(), h * from.twist.linear, h * to.twist.linear);
  RigidMotion out;
  out.pose = {(quaternion_of(rotation.value) * from.pose.rotation).normalized(),
              from.pose.translation + shift.value};
  out.twist = {left_jacobian(rotation.value) * rotation.slope / h, shift.slope / h};
  return out;
}

}  // namespace palpate::dynamics
