#pragma once
#include <memory>
#include <string>

#include "palpate/core/archive.h"
#include "palpate/core/pose.h"
#include "palpate/device/spec.h"

namespace palpate::device {

/// Energy at the device's port, by its samples.  The motors hold a wrench f from one sample to the next, so
/// what the hand puts into the loop over a tick is exactly -f_{k-1} . (x_k - x_{k-1}), and about one axis the
/// same of moments and rotation vectors; what the device dissipates by its own viscous friction b is at least
/// b |x_k - x_{k-1}|^2/T, where positions are read in steps with each axis' difference shorter by one.  The
/// sum of both never falls below zero in a passive loop that stores nothing at the start (Colgate and
/// Schenkel 1997; observer: Hannaford and Ryu 2002).
class PassivityObserver {
 public:
  /// @param damping  of the device along its translations [N s/m]  @param resolution  of its positions [m]
  explicit PassivityObserver(double damping = 0.0, double resolution = 0.0)
      : damping_(damping), resolution_(resolution) {}
  /// A sample of the handle, under the wrench that was held since the last one.
  void sample(double t, const Pose& handle);
  /// The wrench that is held from now on.
  void hold(const Wrench& on_hand) { held_ = on_hand; }

  double energy() const { return energy_; }  ///< that the hand has put in so far, less what it got back [J]
  double least_energy() const { return least_; }  ///< since the start: 0 at most [J]
  double work() const { return work_; }           ///< sum of the magnitudes of the motors' work [J]
  Vec6 last_change() const { return change_; }    ///< of the last tick: rotation vector, translation
  double last_tick() const { return dt_; }        ///< [s]; 0 before the second sample
  /// What the device's friction takes at least while its handle moves by that in a tick as long as the last.
  double friction(const Vec6& change) const;
  void archive(Archive& a);  ///< keeps where it is, or goes on from there

 private:
  double damping_, resolution_, energy_ = 0.0, least_ = 0.0, work_ = 0.0, time_ = 0.0, dt_ = 0.0;
  bool started_ = false;
  Pose last_;
  Vec6 change_ = Vec6::Zero();
  Wrench held_;
};

/// Passivity observer and controller (Hannaford and Ryu 2002, impedance causality), behind the limiter.
///
/// With D the last displacement, the energy at the next sample is foreseen for three guesses of the coming
/// one, D and D +- (D - D_before), as E' = E - f . D' + b |D'|^2/T.  Where the least is negative, a damper
/// takes it over that tick: f_c = f - a D/T with a |D|^2/T = -E'.  It pushes against the motion, never along
/// it.  In a passive loop E' is not negative for any D', so that a wrong guess never dissipates there.  What
/// a tick cannot take, because D was foreseen wrongly or the device is at its maximum, counts in the next.
/// Known limit: `a` is bounded by the device's maximum alone, so that a slow device is braked in jerks.
class PassivityController {
 public:
  /// Off: nothing is counted; observe: counted; control: counted, and made up for.
  enum class Mode { kOff, kObserve, kControl };
  /// @throws Error for a name that is not "off", "observe" or "control"
  static Mode mode_of(const std::string& name);

  /// @param mode  what it does  @param observer  with the device's friction and resolution
  /// @param max_force_n, max_torque_n_m  of the device: the damper's wrench keeps within them too
  PassivityController(Mode mode, double max_force_n, double max_torque_n_m,
                      PassivityObserver observer = PassivityObserver());
  /// @param t  of the sample [s]  @param handle  its pose
  /// @param limited  what the limiter lets out for this sample  @param valid  whether the handle's pose is:
  ///   else nothing is added  @return what goes to the motors
  Wrench apply(double t, const Pose& handle, const Wrench& limited, bool valid = true);
  /// Its count of the energy.
  const PassivityObserver& observer() const { return observer_; }
  double dissipated() const { return dissipated_; }  ///< by the damper so far [J]
  /// Ticks in which the damper acted.
  long active_ticks() const { return active_; }
  /// What it does.
  Mode mode() const { return mode_; }
  void archive(Archive& a);  ///< keeps where it is, or goes on from there

 private:
  double foreseen(const Wrench& wrench, const Vec6& D) const;
  void damp(const Wrench& limited, const Vec6& D, double missing);

  Mode mode_;
  double max_force_, max_torque_, dissipated_ = 0.0;
  long active_ = 0;
  PassivityObserver observer_;
  Wrench damper_;  ///< part of the wrench that is held
};

/// Of a scene's device, with its friction and the steps of its positions; null where the mode is kOff.
/// @throws Error as figures_of() does
std::unique_ptr<PassivityController> make_passivity_controller(PassivityController::Mode mode,
                                                               const DeviceSpec& device);

}  // namespace palpate::device
