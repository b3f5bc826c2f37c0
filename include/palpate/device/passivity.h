#pragma once
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/archive.h"
#include "palpate/core/pose.h"
#include "palpate/device/motors.h"
#include "palpate/device/spec.h"

namespace palpate::device {

/// Energy balance at the device's port, from its samples. The motors hold a wrench f from one sample to the
/// next, so the energy that the hand puts into the loop over a tick is exactly -f . (x_k - x_{k-1}), and
/// correspondingly for moments and rotation vectors about one axis. The viscous friction b of the device
/// dissipates at least b |x_k - x_{k-1}|^2/T; if positions are read in steps, the difference is shortened by
/// one step per axis. The sum of both never falls below zero for a passive loop that stores no energy at the
/// start (Colgate and Schenkel 1997; observer: Hannaford and Ryu 2002). f is the wrench that the motors hold,
/// not the wrench computed last: the two differ by the device's delay, resolution and maximum (Motors). If f
/// changes within a tick its time average is used, which is exact at constant speed.
class PassivityObserver {
 public:
  /// @param damping  viscous friction of the device in translation [N s/m]  @param resolution  resolution of
  /// its positions [m]
  explicit PassivityObserver(double damping = 0.0, double resolution = 0.0)
      : damping_(damping), resolution_(resolution) {}
  /// Adds one sample of the handle, under the wrench held since the last sample.
  void sample(double t, const Pose& handle);
  /// Sets the wrench that the motors hold between the last sample and the next.
  void hold(const Wrench& on_hand) { held_ = on_hand; }

  double energy() const { return energy_; }       ///< Net energy put in by the hand so far [J].
  double least_energy() const { return least_; }  ///< Minimum since the start, at most 0 [J].
  double work() const { return work_; }           ///< Sum of the magnitudes of the motors' work [J].
  Vec6 last_change() const { return change_; }  ///< Change over the last tick: rotation vector, translation.
  double last_tick() const { return dt_; }      ///< Length [s]; 0 before the second sample.
  /// Returns a lower bound on the energy that the device's friction dissipates [J].
  /// @param change  change of the handle's pose, as last_change()  @param dt  its duration [s]
  double friction(const Vec6& change, double dt) const;
  /// Returns the least change of the energy over all motions of the handle within a box under a wrench [J].
  /// @param wrench  wrench that the motors hold  @param low, high  bounds of the displacement, as
  /// last_change()
  /// @param dt  duration of the motion [s]
  double least_change(const Wrench& wrench, const Vec6& low, const Vec6& high, double dt) const;
  void archive(Archive& a);  ///< Writes the state to an archive, or restores it.

 private:
  double damping_, resolution_, energy_ = 0.0, least_ = 0.0, work_ = 0.0, time_ = 0.0, dt_ = 0.0;
  bool started_ = false;
  Pose last_;
  Vec6 change_ = Vec6::Zero();
  Wrench held_;
};

/// Bounds, axis by axis, for the acceleration of a handle in the near future, from its motion so far
/// (derivation: src/device/passivity.cpp).
class AccelerationBound {
 public:
  /// @param horizon  number of ticks that the bound covers
  /// @param rounding  resolution of a sampled position per axis: rotation vector, translation
  explicit AccelerationBound(int horizon = 1, const Vec6& rounding = Vec6::Zero());
  /// Adds the motion of the handle over one more tick.
  /// @param change  change of the pose, as PassivityObserver::last_change()
  void add(const Vec6& change);
  /// Returns the bound for the change of the displacement from tick to tick.
  Vec6 value() const;
  void archive(Archive& a);  ///< Writes the state to an archive, or restores it.

 private:
  int horizon_;
  Vec6 rounding_;
  long count_ = 0;
  Vec6 position_ = Vec6::Zero(), last_ = Vec6::Zero();
  std::vector<Vec6> positions_;  ///< Ring buffer of 2 horizon + 1 positions.
  std::array<Vec6, 5> largest_;  ///< Maxima over the current stretch of `horizon` ticks and the four before.
};

/// Passivity observer and controller (Hannaford and Ryu 2002, impedance causality), behind the limiter.
///
/// A wrench sent now acts after the device's delay, and wrenches already sent can no longer be changed. The
/// controller therefore predicts the minimum of the energy over all motions within bounds, up to the end of
/// the tick in which the new wrench is held, and sends the largest fraction of the wrench that takes this
/// minimum neither below zero nor farther below it. A zero wrench always satisfies this condition: if the
/// handle stays within the bounds the energy never falls below zero, whatever the delay. A passive loop is
/// not modified. Energy lost by a motion beyond the bounds shows in least_energy() and is recovered before
/// wrenches may drive the hand again (derivation: src/device/passivity.cpp).
class PassivityController {
 public:
  /// Mode of operation. kOff: no observation; kObserve: observation only; kControl: observation, and wrenches
  /// are reduced.
  enum class Mode { kOff, kObserve, kControl };
  /// Returns the mode by its name.  @throws Error for a name that is not "off", "observe" or "control"
  static Mode mode_of(const std::string& name);

  /// Parameters of a device and its loop.
  struct Figures {
    double damping = 0.0;              ///< Viscous friction in translation [N s/m].
    double resolution = 0.0;           ///< Resolution of positions [m].
    double angular_resolution = 0.0;   ///< Resolution of angles [rad].
    double mass = 0.045;               ///< Smallest mass that the motors move [kg].
    double rotational_inertia = 1e-3;  ///< Smallest moment of inertia that the motors move [kg m^2].
    double delay = 0.0;                ///< Delay of the motors [s].
    double tick = 1e-3;                ///< Length of a tick [s].
  };
  /// @param mode  observe or control  @param figures  parameters of the device and its loop
  PassivityController(Mode mode, const Figures& figures);
  /// Adds one sample and returns the wrench to be sent to the motors.
  /// @param t  time of the sample [s]  @param handle  pose of the handle
  /// @param motors   motors of the device, advanced to t
  /// @param limited  output of the limiter for this sample
  /// @param valid  whether the handle's pose is valid; if not, the wrench is not reduced
  /// @return wrench to be sent to the motors
  Wrench apply(double t, const Pose& handle, const Motors& motors, const Wrench& limited, bool valid = true);
  /// Returns the observer of the energy.
  const PassivityObserver& observer() const { return observer_; }
  /// Returns the energy that the reductions so far kept from the hand [J]: the work on the hand of the
  /// removed parts of the forces. It is negative where the removed parts would mostly have resisted the
  /// motion: a force is reduced by the motions that the handle may make, of which it then makes one.
  double dissipated() const { return dissipated_; }
  /// Returns the number of ticks in which a wrench was reduced.
  long active_ticks() const { return active_; }
  /// Returns the mode of operation.
  Mode mode() const { return mode_; }
  void archive(Archive& a);  ///< Writes the state to an archive, or restores it.

 private:
  double largest_share(const Motors& motors, const Wrench& limited) const;

  Mode mode_;
  Figures figures_;
  double dissipated_ = 0.0;
  long active_ = 0;
  PassivityObserver observer_;
  AccelerationBound bound_;
  Motors reductions_;  ///< Differences between reduced and limited wrenches, with the same delay.
};
/// Returns the names of the values.
constexpr std::array<std::string_view, 3> option_names(PassivityController::Mode) {
  return {"off", "observe", "control"};
}

/// Builds the controller of a scene's device from its friction, delay and resolutions; null for kOff.
/// @param mode  mode of operation  @param device  spec of the scene's device  @param tick_s  length of a tick
/// [s]
/// @throws Error as figures_of() does
std::unique_ptr<PassivityController> make_passivity_controller(PassivityController::Mode mode,
                                                               const DeviceSpec& device, double tick_s);

}  // namespace palpate::device
