#pragma once
#include "palpate/core/archive.h"
#include "palpate/core/pose.h"
#include "palpate/device/workspace.h"

namespace palpate::device {

class Device;

/// The watchdog: up to kHoldTime after the last valid pose its wrench is held (a pose late by a few ticks is
/// not felt), then it falls smoothly, and from kFallTime on it is zero [s].
inline constexpr double kHoldTime = 0.010, kFallTime = 0.020;

/// Maxima a second [1/s] of a device that the computer moves, where neither scene nor profile says: thirty of
/// them in a tick of 1 ms, which it never slows.  Relative to the device's maxima, so that it suits any
/// device and any units.  A profile's slew is that of an amplifier, 1885 maxima a second; that of a device in
/// a hand follows from its stiffness, 309 maxima a second by default (profile.cpp).
inline constexpr double kDefaultSlew = 3e4;
/// The least slew, in maxima a second: the steepest part of the watchdog's fall, a smoothstep.
inline constexpr double kLeastSlew = 1.5 / (kFallTime - kHoldTime);

/// The last thing before the motors: never lets a wrench above the device's maximum out (smoothly: |f| ->
/// fmax tanh-like, C1, identity to within 1 % below half the maximum), ramps in, bounds the slew, fades
/// outside the device's workspace, and falls from 10 to 20 ms after the last valid pose to zero.
///
/// Before the first tick the output is zero, so the first tick gives zero: a slew needs a time span.  After a
/// fall to zero the wrench ramps in anew. A wrench that is not finite counts as an invalid tick: a NaN never
/// gets out.  So does a time that is not finite or does not increase; the fall then runs on a clock of its
/// own, one last good tick at a time, so that a stopped clock cannot hold a force.
class WrenchLimiter {
 public:
  /// @throws Error for a maximum that is not positive, a negative ramp, or a slew too small to reach zero
  ///   in time (1.5 maximum / 10 ms)
  WrenchLimiter(double max_force_n, double max_torque_n_m, double ramp_s, double max_force_slew_n_s,
                double max_torque_slew_n_m_s);
  /// Slews of kDefaultSlew maxima a second.
  WrenchLimiter(double max_force_n, double max_torque_n_m, double ramp_s)
      : WrenchLimiter(max_force_n, max_torque_n_m, ramp_s, kDefaultSlew * max_force_n,
                      kDefaultSlew * max_torque_n_m) {}
  /// From now on a force at a position of the device outside `workspace` is wanted less, by its share.
  /// @param workspace  where the device can be
  /// @param device  whose last sample says where the handle is; it must outlive this
  void confine(const Workspace& workspace, const Device& device);
  /// @param wanted  force and moment on the hand before the limit
  /// @param t [s], increasing  @param valid  whether the handle's pose of this tick is valid
  Wrench limit(double t, const Wrench& wanted, bool valid);
  /// The hand was without a wrench since the last tick, for longer than its time says: the next valid one
  /// ramps in from zero.  Nothing where there is no ramp: nobody holds the device then.
  void restart();
  /// valid ticks whose wanted force or torque was above its maximum
  long limited_ticks() const { return limited_; }
  /// ticks with a wrench that was not finite or a time that did not increase
  long rejected_ticks() const { return rejected_; }
  /// valid ticks outside the workspace
  long outside_ticks() const { return outside_; }
  void archive(Archive& a);  ///< keeps where it is, or goes on from there

 private:
  Wrench fall(double age);
  Wrench follow(double t, double dt, const Wrench& wanted);

  double max_force_, max_torque_, ramp_, force_slew_, torque_slew_;
  double start_ = 0.0, last_valid_ = 0.0;   ///< first tick of this ramp, last valid tick [s]
  double last_time_ = 0.0, last_dt_ = 0.0;  ///< last tick whose time increased, and its length [s]
  double stalled_ = 0.0;                    ///< what the substitute clock counted since then [s]
  bool started_ = false;                    ///< some tick was seen
  bool live_ = false;                       ///< a valid pose came within the last kFallTime
  Wrench last_;                             ///< what went out last
  Wrench held_;                             ///< what went out at the last valid pose
  Workspace workspace_;                     ///< unbounded but for confine()
  const Device* device_ = nullptr;          ///< null: not confined
  long limited_ = 0, rejected_ = 0, outside_ = 0;
};

}  // namespace palpate::device
