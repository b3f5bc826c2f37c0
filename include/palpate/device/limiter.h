#pragma once
#include "palpate/core/pose.h"

namespace palpate::device {

/// The last thing before the motors: never lets a wrench above the device's maximum out (smoothly: |f| -> fmax tanh-like, C1, identity to within 1 % below half the maximum),
/// ramps in, bounds the slew, and falls to zero within 20 ms after the last valid pose.
class WrenchLimiter {
 public:
  WrenchLimiter(double max_force_n, double max_torque_n_m, double ramp_s, double max_force_slew_n_s = 1e5, double max_torque_slew_n_m_s = 1e4);
  /// @param t [s], increasing  @param valid  whether the handle's pose of this tick is valid
  Wrench limit(double t, const Wrench& wanted, bool valid);
  long limited_ticks() const { return limited_; }

 private:
  double max_force_, max_torque_, ramp_, force_slew_, torque_slew_;
  double start_ = -1.0, last_valid_ = -1.0, last_time_ = 0.0;
  Wrench last_;
  long limited_ = 0;
};

}  // namespace palpate::device
