#include "tick_input.h"

#include <algorithm>
#include <cmath>

#include "palpate/dynamics/path.h"

namespace palpate::tool {
namespace {

template <class Array>
bool all_finite(const Array& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

}  // namespace

RigidMotion handle_at(const TickInput& input, double t) {
  const HandleMotion& m = input.handle;
  const double s = std::clamp((t - input.t0) / input.h, 0.0, 1.0);
  return dynamics::motion_between({m.pose0, m.twist0}, {m.pose1, m.twist1}, input.h, s);
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

bool handle_at_rest(const HandleMotion& m) {
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
  return contact && handle_at_rest(a.handle) && handle_at_rest(b.handle) &&
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
