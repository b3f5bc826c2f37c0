#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "palpate/core/archive.h"
#include "palpate/core/pose.h"
#include "palpate/device/motors.h"
#include "palpate/device/spec.h"

namespace palpate::device {

/// Energy at the device's port, by its samples.  The motors hold a wrench f from one sample to the next, so
/// what the hand puts into the loop over a tick is exactly -f . (x_k - x_{k-1}), and about one axis the same
/// of moments and rotation vectors; what the device dissipates by its own viscous friction b is at least
/// b |x_k - x_{k-1}|^2/T, where positions are read in steps with each axis' difference shorter by one.  The
/// sum of both never falls below zero in a passive loop that stores nothing at the start (Colgate and
/// Schenkel 1997; observer: Hannaford and Ryu 2002).  f is what the motors hold, not what was computed last:
/// the two differ by the device's delay, its steps and its maximum (Motors).  Where f changes within a tick
/// it is the mean, which is exact at constant speed.
class PassivityObserver {
 public:
  /// @param damping  of the device along its translations [N s/m]  @param resolution  of its positions [m]
  explicit PassivityObserver(double damping = 0.0, double resolution = 0.0)
      : damping_(damping), resolution_(resolution) {}
  /// A sample of the handle, under the wrench that was held since the last one.
  void sample(double t, const Pose& handle);
  /// The wrench that the motors hold between the last sample and the next.
  void hold(const Wrench& on_hand) { held_ = on_hand; }

  double energy() const { return energy_; }  ///< that the hand has put in so far, less what it got back [J]
  double least_energy() const { return least_; }  ///< since the start: 0 at most [J]
  double work() const { return work_; }           ///< sum of the magnitudes of the motors' work [J]
  Vec6 last_change() const { return change_; }    ///< of the last tick: rotation vector, translation
  double last_tick() const { return dt_; }        ///< [s]; 0 before the second sample
  /// Returns what the device's friction takes at least [J].
  /// @param change  of the handle's pose, as last_change()  @param dt  that it takes [s]
  double friction(const Vec6& change, double dt) const;
  /// Returns the least change of the energy while the handle moves within a box under a wrench [J].
  /// @param wrench  that the motors hold  @param low, high  of the displacement, as last_change()
  /// @param dt  that the motion takes [s]
  double least_change(const Wrench& wrench, const Vec6& low, const Vec6& high, double dt) const;
  void archive(Archive& a);  ///< keeps where it is, or resumes from there

 private:
  double damping_, resolution_, energy_ = 0.0, least_ = 0.0, work_ = 0.0, time_ = 0.0, dt_ = 0.0;
  bool started_ = false;
  Pose last_;
  Vec6 change_ = Vec6::Zero();
  Wrench held_;
};

/// Bounds of a handle's acceleration in the near future, axis by axis, from its motion so far
/// (src/device/passivity.cpp derives them).
class AccelerationBound {
 public:
  /// @param horizon  ticks that the bound is for
  /// @param rounding  of a sampled position, of each axis: rotation vector, translation
  explicit AccelerationBound(int horizon = 1, const Vec6& rounding = Vec6::Zero());
  /// Takes the handle's motion over one more tick.
  /// @param change  of its pose, as PassivityObserver::last_change()
  void add(const Vec6& change);
  /// Returns the bound of the change of the displacement from tick to tick.
  Vec6 value() const;
  void archive(Archive& a);  ///< keeps where it is, or resumes from there

 private:
  int horizon_;
  Vec6 rounding_;
  long count_ = 0;
  Vec6 position_ = Vec6::Zero(), last_ = Vec6::Zero();
  std::vector<Vec6> positions_;  ///< a ring of 2 horizon + 1
  std::array<Vec6, 5> largest_;  ///< of this stretch of `horizon` ticks and of the four before it
};

/// Passivity observer and controller (Hannaford and Ryu 2002, impedance causality), behind the limiter.
///
/// A wrench that is sent now acts when the device's delay is over, and those on their way can no longer be
/// changed.  So the controller foresees the energy up to the end of the tick in which the new wrench is held,
/// at its least over all motions within bounds, and sends the largest share of the wrench that takes it
/// neither below zero nor farther below.  No wrench at all always does: where the handle keeps within the
/// bounds the energy never falls below zero, whatever the delay; a loop that is passive is left alone.  What
/// a motion beyond the bounds takes shows in least_energy() and is made up for before wrenches may drive the
/// hand again (derivation: src/device/passivity.cpp).
class PassivityController {
 public:
  /// Off: nothing is counted; observe: counted; control: counted, and wrenches are reduced.
  enum class Mode { kOff, kObserve, kControl };
  /// @throws Error for a name that is not "off", "observe" or "control"
  static Mode mode_of(const std::string& name);

  /// Figures of a device and its loop.
  struct Figures {
    double damping = 0.0;              ///< viscous, of its translations [N s/m]
    double resolution = 0.0;           ///< of its positions [m]
    double angular_resolution = 0.0;   ///< of its angles [rad]
    double mass = 0.045;               ///< that its motors move at least [kg]
    double rotational_inertia = 1e-3;  ///< the same about an axis [kg m^2]
    double delay = 0.0;                ///< of its motors [s]
    double tick = 1e-3;                ///< length of a tick [s]
  };
  /// @param mode  observe or control  @param figures  of the device
  PassivityController(Mode mode, const Figures& figures);
  /// @param t  of the sample [s]  @param handle  its pose
  /// @param motors   of the device, advanced to t
  /// @param limited  what the limiter lets out for this sample  @param valid  whether the handle's pose is:
  ///   else nothing is reduced  @return what is sent to the motors
  Wrench apply(double t, const Pose& handle, const Motors& motors, const Wrench& limited, bool valid = true);
  /// Its count of the energy.
  const PassivityObserver& observer() const { return observer_; }
  double dissipated() const { return dissipated_; }  ///< kept from the hand by reduced wrenches so far [J]
  /// Ticks in which a wrench was reduced.
  long active_ticks() const { return active_; }
  /// What it does.
  Mode mode() const { return mode_; }
  void archive(Archive& a);  ///< keeps where it is, or resumes from there

 private:
  double largest_share(const Motors& motors, const Wrench& limited) const;

  Mode mode_;
  Figures figures_;
  double dissipated_ = 0.0;
  long active_ = 0;
  PassivityObserver observer_;
  AccelerationBound bound_;
  Motors reductions_;  ///< what was taken off the wrenches, under the same delay
};

/// Makes the controller of a scene's device, with its friction, delay and the steps of its positions; null
/// where the mode is kOff.
/// @param mode  observe or control  @param device  of the scene  @param tick_s  length of a tick [s]
/// @throws Error as figures_of() does
std::unique_ptr<PassivityController> make_passivity_controller(PassivityController::Mode mode,
                                                               const DeviceSpec& device, double tick_s);

}  // namespace palpate::device
