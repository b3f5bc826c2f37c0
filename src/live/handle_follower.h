#pragma once
#include "palpate/core/pose.h"

namespace palpate::live {

/// Rate and bounds of a HandleFollower.
struct FollowerLimits {
  double rate_per_s = 100.0;  ///< w of the equation [1/s]; the handle lags a moving target by 2/w.
  double speed_m_s = 0.5;     ///< Largest speed of the handle.
  double turn_rad_s = 6.0;    ///< Largest angular speed of the handle.
};

/// Smooth motion of a handle after a target that moves in steps, as a pointer in a browser does (60 to 240
/// per second, irregular). Critically damped, with a bounded pull:
///
///     x'' = w^2 d - 2 w x',   d = r - x, shortened to |d| <= L = 2 V/w
///
/// - A target that moves at a constant speed below V is followed without overshoot, 2/w = 20 ms late.
/// - |x'| <= w L/2 = V: d|x'|/dt <= w^2 L - 2 w |x'| is negative above V. Therefore |x''| <= 4 w V.
/// - A target that steps at 60 Hz and moves at v gives the handle a speed between 0.80 v and 1.11 v: the
///   responses w^2 t exp(-w t) v/60 to its steps, summed.
///
/// A step of length h is exact for a d that follows a fixed target; it never exceeds V, whatever h. Rotations
/// follow the same equation, with d the rotation vector from the handle to the target in world axes.
class HandleFollower {
 public:
  /// Starts at rest.  @param start  pose of the handle
  explicit HandleFollower(const Pose& start, const FollowerLimits& limits = {});
  /// Advances by h >= 0 [s] towards the target; no motion for h = 0.
  void advance(double h, const Pose& target);

  const Pose& pose() const { return pose_; }
  const Twist& twist() const { return twist_; }                ///< At the end of the step.
  const Twist& acceleration() const { return acceleration_; }  ///< At the end of the step.

 private:
  FollowerLimits limits_;
  Pose pose_;
  Twist twist_, acceleration_;
};

}  // namespace palpate::live
