#include "rate_control.h"

#include <algorithm>
#include <cmath>

#include "check_range.h"
#include "palpate/device/profile.h"

namespace palpate::device {
namespace {

Vec3 finite(const char* key, const Vec3& v) {
  if (!v.allFinite()) fail("device: {} must be three finite numbers", key);
  return v;
}

}  // namespace

RateControl::RateControl(const DeviceSpec& spec)
    : max_speed_(spec.max_speed_m_s),
      max_turn_rate_(spec.max_turn_rate_rad_s),
      dead_zone_(spec.dead_zone),
      workspace_(figures_of(spec).workspace) {
  check_range("max_speed_m_s", max_speed_, DeviceRanges::full_speed);
  check_range("max_turn_rate_rad_s", max_turn_rate_, DeviceRanges::full_speed);
  check_range("dead_zone", dead_zone_, DeviceRanges::dead_zone);
  mounting_ = quaternion_of(finite("mounting_rotation_rad", spec.mounting_rotation_rad)).toRotationMatrix();
  pose_.translation = finite("start_position_m", spec.start_position_m.value_or(spec.workspace_center_m));
  pose_.rotation = quaternion_of(
      finite("start_rotation_vector_rad", spec.start_rotation_vector_rad.value_or(Vec3::Zero())));
}

Vec3 RateControl::velocity(const Vec3& deflection, double full) const {
  const auto shaped = [this](double d) {
    const double beyond = (std::min(std::abs(d), 1.0) - dead_zone_) / (1.0 - dead_zone_);
    return std::copysign(std::max(beyond, 0.0), d);
  };
  return full * (mounting_ * deflection.unaryExpr(shaped));
}

Vec3 RateControl::inside(const Vec3& p) const {
  Vec3 out = p;
  const auto into_ball = [&out](const Vec3& center, double radius) {
    const Vec3 arm = out - center;
    if (arm.norm() > radius) out = center + arm * (radius / arm.norm());
  };
  if (!workspace_.size.isZero(0.0))
    out = out.cwiseMax(workspace_.center - 0.5 * workspace_.size)
              .cwiseMin(workspace_.center + 0.5 * workspace_.size);
  if (workspace_.radius > 0.0) into_ball(workspace_.center, workspace_.radius);
  if (bounds_.radius < HUGE_VAL) into_ball(bounds_.center, bounds_.radius);
  return out;
}

void RateControl::advance(double t, const Deflection& deflection) {
  const double h = time_ ? std::max(t - *time_, 0.0) : 0.0;
  time_ = t;
  pose_.translation += h * twist_.linear;
  pose_.rotation = (quaternion_of(h * twist_.angular) * pose_.rotation).normalized();
  // A handle that starts outside moves freely inwards; it is not moved by a jump.
  constexpr double kAhead = 1e-3;  // [s], a tick
  Vec3 v = velocity(deflection.linear, max_speed_);
  const Vec3 ahead = pose_.translation + kAhead * v, here = inside(pose_.translation), next = inside(ahead);
  if (here != pose_.translation) {
    if (v.dot(here - pose_.translation) < 0.0) v.setZero();
  } else if (next != ahead) {
    v = (next - here) / kAhead;
  }
  twist_.linear = v;
  twist_.angular = velocity(deflection.angular, max_turn_rate_);
}

}  // namespace palpate::device
