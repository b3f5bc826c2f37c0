#include <algorithm>
#include <cmath>
#include <numbers>

#include "palpate/core/error.h"
#include "palpate/core/registry.h"
#include "palpate/device/keyframes.h"

namespace palpate::device {
namespace {

/// Position along a segment: s in [0, 1] and its first two time derivatives.
struct Blend {
  double s = 0.0, s_dot = 0.0, s_ddot = 0.0;
};

// x = (t - t0)/T. The quintic with s(0) = 0, s(1) = 1 and s', s'' zero at both ends minimises the integral of
// the squared jerk (Flash and Hogan 1985): s = 10 x^3 - 15 x^4 + 6 x^5. As it is at rest at each keyframe,
// the path is C2 there.
Blend minimum_jerk(double x, double T) {
  const double y = 1.0 - x;
  return {x * x * x * (10.0 - 15.0 * x + 6.0 * x * x), 30.0 * x * x * y * y / T,
          60.0 * x * y * (1.0 - 2.0 * x) / (T * T)};
}
Blend linear(double x, double T) { return {x, 1.0 / T, 0.0}; }

Blend blend_of(Interpolation interpolation, double x, double T) {
  switch (interpolation) {
    case Interpolation::kMinimumJerk: return minimum_jerk(x, T);
    case Interpolation::kLinear: return linear(x, T);
    case Interpolation::kStep: break;
  }
  return {};  // Stays until the time of the next keyframe, where the next segment begins.
}

Pose pose_of(const KeyframeSpec& key) { return {quaternion_of(key.rotation_vector_rad), key.position_m}; }

HandleSample at_rest(const KeyframeSpec& key) {
  HandleSample sample;
  sample.pose = pose_of(key);
  return sample;
}

}  // namespace

// With d the rotation vector from the first orientation to the second (world axes), R(t) = exp(s d) R0. The
// axis of d is fixed, so the right (and left) Jacobian of SO(3) at s d maps d to itself: omega =
// J(s d) (s' d) = s' d, and alpha = s'' d. Both are exact.
HandleSample sample_keyframes(const std::vector<KeyframeSpec>& keyframes, double t) {
  if (keyframes.empty()) fail("keyframes: the path is empty; give at least one keyframe");
  if (!(t >= keyframes.front().time_s)) return at_rest(keyframes.front());
  if (t >= keyframes.back().time_s) return at_rest(keyframes.back());
  const auto to = std::upper_bound(keyframes.begin(), keyframes.end(), t,
                                   [](double time, const KeyframeSpec& key) { return time < key.time_s; });
  const auto from = to - 1;

  const double T = to->time_s - from->time_s;
  const Blend blend = blend_of(to->interpolation, (t - from->time_s) / T, T);
  const Pose start = pose_of(*from);
  const Vec6 d = pose_difference(start, pose_of(*to));
  HandleSample sample;
  sample.pose.rotation = quaternion_of(blend.s * d.head<3>()) * start.rotation;
  sample.pose.translation = start.translation + blend.s * d.tail<3>();
  sample.twist = {blend.s_dot * d.head<3>(), blend.s_dot * d.tail<3>()};
  sample.acceleration = {blend.s_ddot * d.head<3>(), blend.s_ddot * d.tail<3>()};
  return sample;
}

void check_keyframes(const std::vector<KeyframeSpec>& keyframes, const std::string& where) {
  if (keyframes.empty())
    fail("{}: no keyframes; give at least one (a single keyframe holds the handle still)", where);
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const KeyframeSpec& key = keyframes[i];
    if (!std::isfinite(key.time_s) || !key.position_m.allFinite() || !key.rotation_vector_rad.allFinite())
      fail("{}: keyframes[{}]: time, position and rotation must be finite numbers", where, i);
    if (i == 0) continue;
    const KeyframeSpec& before = keyframes[i - 1];
    if (!(key.time_s > before.time_s))
      fail(
          "{}: keyframes[{}]: time_s = {} must be greater than that of the previous keyframe ({}); for a "
          "jump use interpolation = \"step\"",
          where, i, key.time_s, before.time_s);
    // exp is a contraction from rotation vectors to rotations, so a difference of at most pi cannot hide a
    // longer rotation.
    const double angle = (key.rotation_vector_rad - before.rotation_vector_rad).norm();
    if (angle > std::numbers::pi * (1.0 + 1e-12))
      fail(
          "{}: keyframes[{}]: rotation_vector_rad is {:.6g} rad from that of the previous keyframe; more "
          "than half a turn is ambiguous, so insert a keyframe",
          where, i, angle);
  }
}

}  // namespace palpate::device
