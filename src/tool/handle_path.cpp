#include "handle_path.h"

#include <algorithm>
#include <cmath>

#include "so3.h"

namespace palpate::tool {
namespace {

/// Cubic through 0 and `end` with slopes `m0`, `m1` by s: value and derivative at s in [0, 1].
struct Hermite {
  Vec3 value, slope;
};
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

// Rotation: theta(s) from 0 to d, the rotation vector of R1 R0^T, with R(s) = exp(theta) R0 and
// omega = J(theta) theta'/h.  The slopes at the ends follow from the twists: h omega0 at
// s = 0 (J(0) = I) and h J^-1(d) omega1 at s = 1.
RigidMotion handle_at(const TickInput& input, double t) {
  const HandleMotion& m = input.handle;
  const double s = std::clamp((t - input.t0) / input.h, 0.0, 1.0), h = input.h;
  const Vec6 d = pose_difference(m.pose0, m.pose1);
  const Hermite rotation = hermite(s, d.head<3>(), h * m.twist0.angular,
                                   h * left_jacobian_inverse(d.head<3>()) * m.twist1.angular);
  const Hermite shift = hermite(s, d.tail<3>(), h * m.twist0.linear, h * m.twist1.linear);
  RigidMotion out;
  out.pose = {quaternion_of(rotation.value) * m.pose0.rotation, m.pose0.translation + shift.value};
  out.twist = {left_jacobian(rotation.value) * rotation.slope / h, shift.slope / h};
  return out;
}

Vec6 applied_wrench(const TickInput& input, double t, const RigidMotion& tool) {
  return coupling_wrench(input.gains, tool, handle_at(input, t)) +
         dynamics::contact_wrench(input.contact, t, tool.pose, tool.twist);
}

TickInput with_handle_held(const TickInput& input, const Pose& pose, const Twist& twist) {
  TickInput held = input;
  held.handle = {pose, pose, twist, twist};
  return held;
}

namespace {

bool stands_still(const HandleMotion& m) {
  return m.pose0.translation == m.pose1.translation &&
         m.pose0.rotation.coeffs() == m.pose1.rotation.coeffs() && m.twist0.linear.isZero(0.0) &&
         m.twist0.angular.isZero(0.0) && m.twist1.linear.isZero(0.0) && m.twist1.angular.isZero(0.0);
}

}  // namespace

bool same_wrench(const TickInput& a, const TickInput& b) {
  const auto &c = a.contact, &d = b.contact;
  const bool contact = c.time == d.time && c.x0 == d.x0 && c.v0 == d.v0 && c.F0 == d.F0 && c.F1 == d.F1 &&
                       c.J == d.J && c.B == d.B;
  const CouplingGains &g = a.gains, &f = b.gains;
  return contact && stands_still(a.handle) && stands_still(b.handle) &&
         a.handle.pose0.translation == b.handle.pose0.translation &&
         a.handle.pose0.rotation.coeffs() == b.handle.pose0.rotation.coeffs() && g.k == f.k && g.b == f.b &&
         g.k_r == f.k_r && g.b_r == f.b_r;
}

bool is_finite(const RigidMotion& m) {
  return m.pose.rotation.coeffs().allFinite() && m.pose.translation.allFinite() &&
         m.twist.angular.allFinite() && m.twist.linear.allFinite();
}

bool is_finite(const TickInput& input) {
  const HandleMotion& m = input.handle;
  const dynamics::LinearisedContact& c = input.contact;
  const bool handle = is_finite(RigidMotion{m.pose0, m.twist0}) && is_finite(RigidMotion{m.pose1, m.twist1});
  return handle && all_finite(c.x0) && all_finite(c.v0) && all_finite(c.F0) && all_finite(c.F1) &&
         all_finite(c.J) && all_finite(c.B);
}

}  // namespace palpate::tool
