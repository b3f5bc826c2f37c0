#include "handle_path.h"

#include <algorithm>
#include <cmath>

#include "so3.h"

namespace palpate::tool {
namespace {

/// Cubic through 0 and `end` with slopes `m0`, `m1` by s: value and derivative at s in [0, 1].
struct Hermite { Vec3 value, slope; };
Hermite hermite(double s, const Vec3& end, const Vec3& m0, const Vec3& m1) {
  const double r = 1.0 - s;
  return {s * s * (3.0 - 2.0 * s) * end + s * r * r * m0 - s * s * r * m1,
          6.0 * s * r * end + r * (1.0 - 3.0 * s) * m0 + s * (3.0 * s - 2.0) * m1};
}

template <class Array>
bool all_finite(const Array& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

}  // namespace

// Rotation: theta(s) from 0 to d, the rotation vector of R1 R0^T, with R(s) = exp(theta) R0 and omega = J(theta) theta'/h.  The slopes at the ends
// follow from the twists: h omega0 at s = 0 (J(0) = I) and h J^-1(d) omega1 at s = 1.
RigidMotion handle_at(const TickInput& input, double t) {
  const HandleMotion& m = input.handle;
  const double s = std::clamp((t - input.t0) / input.h, 0.0, 1.0), h = input.h;
  const Vec6 d = pose_difference(m.pose0, m.pose1);
  const Hermite turn = hermite(s, d.head<3>(), h * m.twist0.angular, h * left_jacobian_inverse(d.head<3>()) * m.twist1.angular);
  const Hermite shift = hermite(s, d.tail<3>(), h * m.twist0.linear, h * m.twist1.linear);
  RigidMotion out;
  out.pose = {quaternion_of(turn.value) * m.pose0.rotation, m.pose0.translation + shift.value};
  out.twist = {left_jacobian(turn.value) * turn.slope / h, shift.slope / h};
  return out;
}

Vec6 applied_wrench(const TickInput& input, double t, const RigidMotion& tool) {
  return coupling_wrench(input.gains, tool, handle_at(input, t)) + dynamics::contact_wrench(input.contact, t, tool.pose, tool.twist);
}

TickInput with_handle_held(const TickInput& input, const Pose& pose, const Twist& twist) {
  TickInput held = input;
  held.handle = {pose, pose, twist, twist};
  return held;
}

bool is_finite(const RigidMotion& m) {
  return m.pose.rotation.coeffs().allFinite() && m.pose.translation.allFinite() && m.twist.angular.allFinite() && m.twist.linear.allFinite();
}

bool is_finite(const TickInput& input) {
  const HandleMotion& m = input.handle;
  const dynamics::LinearisedContact& c = input.contact;
  const bool handle = is_finite(RigidMotion{m.pose0, m.twist0}) && is_finite(RigidMotion{m.pose1, m.twist1});
  return handle && all_finite(c.x0) && all_finite(c.v0) && all_finite(c.F0) && all_finite(c.F1) && all_finite(c.J) && all_finite(c.B);
}

}  // namespace palpate::tool
