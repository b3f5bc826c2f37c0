#pragma once
#include "palpate/core/archive.h"
#include "palpate/core/pose.h"
#include "palpate/device/workspace.h"

namespace palpate::device {

class Device;

/// Times of the watchdog [s]: the wrench is held for kHoldTime after the last valid pose, so that a pose that
/// is late by a few ticks has no effect, then decreases smoothly, and is zero from kFallTime on.
inline constexpr double kHoldTime = 0.010, kFallTime = 0.020;

/// Default slew rate in maxima per second [1/s] for a device that the computer moves, if neither scene nor
/// profile specifies one: thirty maxima per tick of 1 ms, so that it never limits. It is relative to the
/// device's maxima to suit any device and units. The slew of a profile is that of the motor's amplifier, 1885
/// maxima per second; the slew of a hand-held device follows from its stiffness, 309 maxima per second by
/// default (profile.cpp).
inline constexpr double kDefaultSlew = 3e4;
/// Smallest permitted slew rate, in maxima per second: the steepest slope of the watchdog's smoothstep.
inline constexpr double kLeastSlew = 1.5 / (kFallTime - kHoldTime);

/// Last stage before the motors. It limits the wrench to the device's maximum (smoothly: |f| -> fmax,
/// tanh-like, C1, identity to within 1 % below half the maximum), ramps it in, bounds its slew rate, fades it
/// outside the device's workspace, and lets it fall to zero from 10 to 20 ms after the last valid pose.
///
/// The first tick returns zero, because a slew rate needs a time span. After a fall to zero the wrench ramps
/// in again. A wrench that is not finite counts as an invalid tick, so that no NaN reaches the motors. A time
/// that is not finite or does not increase also counts as invalid; the fall then runs on a substitute clock,
/// which advances by the length of the last valid tick per call, so that a stopped clock cannot hold a force.
class WrenchLimiter {
 public:
  /// @throws Error for a maximum that is not positive, a negative ramp, or a slew rate too small to reach
  /// zero in time (1.5 maximum / 10 ms)
  WrenchLimiter(double max_force_n, double max_torque_n_m, double ramp_s, double max_force_slew_n_s,
                double max_torque_slew_n_m_s);
  /// Limiter with slew rates of kDefaultSlew maxima per second.
  WrenchLimiter(double max_force_n, double max_torque_n_m, double ramp_s)
      : WrenchLimiter(max_force_n, max_torque_n_m, ramp_s, kDefaultSlew * max_force_n,
                      kDefaultSlew * max_torque_n_m) {}
  /// Fades the wrench outside `workspace` from now on, by the factor Workspace::share().
  /// @param workspace  region that the device can reach
  /// @param device  its last sample is the position of the handle; it must outlive the limiter
  void confine(const Workspace& workspace, const Device& device);
  /// Returns the limited wrench of one tick.
  /// @param requested  requested force and moment on the hand
  /// @param t  time [s], increasing  @param valid  whether the handle's pose of this tick is valid
  Wrench limit(double t, const Wrench& requested, bool valid);
  /// Restarts the ramp: the next valid wrench ramps in from zero. To be called if no wrench reached the hand
  /// since the last tick for longer than its times show. No effect without a ramp, as nobody holds the device
  /// then.
  void restart();
  /// Returns the number of valid ticks whose requested force or torque exceeded its maximum.
  long limited_ticks() const { return limited_; }
  /// Returns the number of ticks with a wrench that was not finite or a time that did not increase.
  long rejected_ticks() const { return rejected_; }
  /// Returns the number of valid ticks outside the workspace.
  long outside_ticks() const { return outside_; }
  /// Returns the number of ticks whose last valid pose is at least kFallTime old, so that the wrench is zero.
  long ticks_without_pose() const { return without_pose_; }
  void archive(Archive& a);  ///< Writes the state to an archive, or restores it.

 private:
  Wrench fall(double age);
  Wrench follow(double t, double dt, const Wrench& requested);

  double max_force_, max_torque_, ramp_, force_slew_, torque_slew_;
  double start_ = 0.0, last_valid_ = 0.0;   ///< First tick of this ramp, last valid tick [s].
  double last_time_ = 0.0, last_dt_ = 0.0;  ///< Last tick whose time increased, and its length [s].
  double stalled_ = 0.0;                    ///< Time on the substitute clock since then [s].
  bool started_ = false;                    ///< A tick has been processed.
  bool live_ = false;                       ///< A valid pose arrived within the last kFallTime.
  Wrench last_;                             ///< Last output.
  Wrench held_;                             ///< Output at the last valid pose.
  Workspace workspace_;                     ///< Unbounded without confine().
  const Device* device_ = nullptr;          ///< null: not confined
  long limited_ = 0, rejected_ = 0, outside_ = 0, without_pose_ = 0;
};

}  // namespace palpate::device
