#pragma once
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/archive.h"
#include "palpate/core/pose.h"
#include "palpate/device/spec.h"
#include "palpate/device/specification.h"

namespace palpate::device {

/// State of the handle at one instant, in the scene's axes (right-handed) and SI units.
struct HandleSample {
  Pose pose;                   ///< Origin [m] and orientation of the handle.
  Twist twist;                 ///< [rad/s, m/s]
  Twist acceleration;          ///< [rad/s^2, m/s^2]
  bool valid = true;           ///< false: no pose arrived; forces must fall to zero
  std::uint32_t switches = 0;  ///< bit i: switch i is pressed
  /// Writes the sample to an archive, or restores it.
  void archive(Archive& a) {
    a("pose", pose);
    a("twist", twist);
    a("acceleration", acceleration);
    a("valid", valid);
    a("switches", switches);
  }
};

/// Linear map from the times of a recording to the scene's times: t = scale * t_file + offset.
struct RecordingClock {
  double scale = 1.0;   ///< seconds per unit of the file's times
  double offset = 0.0;  ///< [s]
  /// Returns the clock that the scene specifies.  @throws Error for a scale that is not positive or an offset
  /// that is not finite
  static RecordingClock of(const DeviceSpec& spec);
  /// @param t_file  time in the file's units  @returns the scene's time [s]
  double operator()(double t_file) const { return scale * t_file + offset; }
};

/// Closed interval of time [s].
struct TimeSpan {
  double first = 0.0, last = 0.0;  ///< Both ends are included.
};

/// Bounds for poses and speeds of a handle. A pose outside them is an error of its sender.
struct PoseBounds {
  Vec3 center = Vec3::Zero();  ///< Centre of the ball [m].
  double radius = HUGE_VAL;    ///< Radius of the ball that contains all valid handle positions [m].
  double speed = HUGE_VAL, rotation = HUGE_VAL;  ///< Largest speed [m/s] and angular speed [rad/s].
  /// Returns whether a pose and twist are within the bounds.
  bool hold(const Pose& pose, const Twist& twist) const;
};

/// Haptic device, held by a hand: its pose is read, and a wrench is sent to it.
///
/// All quantities are in the scene's axes; a device with other axes converts them. The loop calls `sample`
/// once or more per tick, with times that do not decrease (calls with the same time return the same sample),
/// and then `feedback` with the wrench on the hand until the next call. The first sample opens the device;
/// the destructor of each derived device closes it.
///
/// A user-defined device overrides `do_sample` and, if it has motors, `do_feedback`; see docs/devices.md.
class Device {
 public:
  Device() = default;
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Opens the hardware, socket or file. No effect if it is open.  @throws Error if that fails
  void open();
  /// Switches the motors off and releases all resources. No effect if the device is closed.
  void close();
  /// Returns whether the device is open.
  bool is_open() const { return open_; }

  /// Returns the state of the handle at time t [s]; opens the device if it is closed.  @throws Error if it
  /// cannot be opened
  HandleSample sample(double t);
  /// Sends the wrench of a tick to the motors.
  /// @param t  time of the tick [s]
  /// @param on_hand  force [N] and moment about the handle's origin [N m] on the hand, scene's axes
  void feedback(double t, const Wrench& on_hand);
  /// Calls `feedback` with the time of the last sample.
  void set_force_and_torque(const Vec3& force, const Vec3& torque) { feedback(time_, {torque, force}); }

  // State at the last sample; before the first, at rest at the origin.
  Vec3 position() const { return last_.pose.translation; }       ///< [m]
  Quat rotation() const { return last_.pose.rotation; }          ///< From the handle's axes to the scene's.
  Vec3 linear_velocity() const { return last_.twist.linear; }    ///< [m/s]
  Vec3 angular_velocity() const { return last_.twist.angular; }  ///< [rad/s]
  std::uint32_t switches() const { return last_.switches; }      ///< Bit i: switch i is pressed.

  /// Returns the capabilities of the device; figures that are not known are left empty.
  virtual DeviceSpecification specification() const = 0;
  /// Returns the capabilities that a driver reports of its hardware, which take the place of a profile;
  /// empty: none.
  virtual std::optional<DeviceSpecification> reported() const { return {}; }
  /// Returns the motion as a function of time, valid at any time, if it is known in advance; empty if the
  /// motion depends on the wrench or on a person. Monolithic integration of tool and bodies requires it.
  virtual std::function<HandleSample(double t)> path() const { return {}; }

  /// Returns the time span of the recording on the scene's clock; empty if the device does not replay a
  /// recording.
  virtual std::optional<TimeSpan> recorded() const { return {}; }

  /// Returns whether the device is moved from outside this program in wall-clock time, which requires a run
  /// in real time.
  virtual bool is_live() const { return false; }
  /// Returns a description of the event that a run must wait for, such as "the first pose at ..."; empty:
  /// none.
  virtual std::string awaited() const { return {}; }
  /// Opens the device and waits for that event before the clock starts. Returns early if `stop` is set.
  /// @param t  time of the run's start [s]  @param stop  may be null
  /// @throws Error if the event did not occur in time
  void await(double t, const std::atomic<bool>* stop);
  /// Tells a device whose handle has no place in space of its own, such as a pointer, where to start: at the
  /// pose of the tool at the start of the run. Called before the first sample. Other devices ignore it.
  virtual void start_at(const Pose&) {}
  /// Sets bounds outside which poses are dropped, for devices whose poses come from an untrusted source.
  virtual void bound(const PoseBounds&) {}

  /// Returns counters by name, such as the number of dropped packets. Read after the loop has ended.
  virtual std::vector<std::pair<std::string, long long>> counters() const { return {}; }

  /// Returns whether the device can be resumed from an archive, i.e. whether archive() covers its complete
  /// state. Devices with a hand beyond a network or a motor cannot.
  virtual bool can_be_archived() const { return false; }
  /// Writes the state to an archive, or restores it.
  /// @pre can_be_archived(); for restoring, nothing was sampled before
  void archive(Archive& a);

 protected:
  /// Opens the resources of the device; no effect for devices without any.  @throws Error if that fails
  virtual void do_open() {}
  /// Releases the resources; called at most once per do_open(). Must not throw.
  virtual void do_close() {}
  /// Implements await() for an open device; no effect for devices that need not wait.
  virtual void do_await(double /*t*/, const std::atomic<bool>* /*stop*/) {}
  /// Returns the state of the handle at time t [s] without waiting; `valid` is false while nothing new has
  /// arrived.
  virtual HandleSample do_sample(double t) = 0;
  /// Applies the wrench from t [s] on, about the handle's origin, scene's axes; no effect for devices without
  /// motors.
  virtual void do_feedback(double /*t*/, const Wrench& /*on_hand*/) {}
  /// Writes or restores the state in addition to the last sample.
  virtual void do_archive(Archive&) {}

 private:
  HandleSample last_;
  double time_ = 0.0;  ///< Time of the last sample [s].
  bool open_ = false;
};

}  // namespace palpate::device
