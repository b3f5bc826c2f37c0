#pragma once
#include "palpate/device/device.h"
#include "palpate/device/spec.h"
#include "palpate/device/workspace.h"

namespace palpate::device {

/// Deflections of a spring-centred control from its rest position, each axis from -1 to 1, in the device's
/// axes: x to the right, y away from the user, z up.
struct Deflection {
  Vec3 linear = Vec3::Zero();   ///< Displacement along the axes.
  Vec3 angular = Vec3::Zero();  ///< Rotation about the axes.
};

/// Rate control: the deflection sets the handle's velocity.
///
///   v = v_max g(d),  g(d) = sign(d) max(0, (|d| - z) / (1 - z)) per axis, with dead zone z;
///   p(t) = p(t0) + v (t - t0),  R(t) = exp(w (t - t0)) R(t0) until the next sample.
///
/// The handle stays in the workspace: at its border the velocity keeps only the part along or away from it.
class RateControl {
 public:
  /// @throws Error for parameters out of range
  explicit RateControl(const DeviceSpec& spec);
  /// Keeps the handle in this ball, too.
  void bound(const PoseBounds& bounds) { bounds_ = bounds; }
  /// Moves the handle to time t [s] with its last velocity, then sets the velocity.
  /// @param deflection  before the dead zone; values beyond 1 count as 1
  void advance(double t, const Deflection& deflection);
  const Pose& pose() const { return pose_; }
  const Twist& twist() const { return twist_; }

 private:
  Vec3 velocity(const Vec3& deflection, double full) const;
  Vec3 inside(const Vec3& p) const;

  double max_speed_, max_turn_rate_, dead_zone_;
  Mat3 mounting_;
  Workspace workspace_;
  PoseBounds bounds_;
  Pose pose_;
  Twist twist_;
  std::optional<double> time_;  ///< Time of the last sample [s].
};

}  // namespace palpate::device
