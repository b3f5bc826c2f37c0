#include "live/handle_follower.h"

#include <cmath>

namespace palpate::live {
namespace {

struct Motion {
  Vec3 shift, velocity, acceleration;
};

// With e = x - r and c = v + w e:  e(h) = (e + c h) exp(-w h),  v(h) = (v - w c h) exp(-w h).
Motion step(const Vec3& difference, const Vec3& velocity, double h, double w, double speed) {
  const double length = difference.norm(), longest = 2.0 * speed / w;
  const Vec3 d = length > longest ? Vec3(longest / length * difference) : difference;
  const Vec3 e = -d, c = velocity + w * e;
  const double decay = std::exp(-w * h);
  const Vec3 left = (e + h * c) * decay, v = (velocity - w * h * c) * decay;
  return {d + left, v, -w * w * left - 2.0 * w * v};
}

}  // namespace

HandleFollower::HandleFollower(const Pose& start, const FollowerLimits& limits)
    : limits_(limits), pose_(start) {
  pose_.rotation.normalize();
}

void HandleFollower::advance(double h, const Pose& target) {
  if (!(h > 0.0)) return;
  const Vec6 difference = pose_difference(pose_, target);
  const double w = limits_.rate_per_s;
  const Motion turn = step(difference.head<3>(), twist_.angular, h, w, limits_.turn_rad_s),
               move = step(difference.tail<3>(), twist_.linear, h, w, limits_.speed_m_s);
  pose_.translation += move.shift;
  pose_.rotation = (quaternion_of(turn.shift) * pose_.rotation).normalized();
  twist_ = {turn.velocity, move.velocity};
  acceleration_ = {turn.acceleration, move.acceleration};
}

}  // namespace palpate::live
