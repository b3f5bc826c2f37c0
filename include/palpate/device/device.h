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
#include "palpate/core/registry.h"
#include "palpate/device/profile.h"
#include "palpate/device/spec.h"

namespace palpate::device {

/// The handle as the hand moves it at one instant, in the scene's axes (right-handed) and SI units.
struct HandleSample {
  Pose pose;                   ///< of the handle: its origin [m] and orientation
  Twist twist;                 ///< [rad/s, m/s]
  Twist acceleration;          ///< [rad/s^2, m/s^2]
  bool valid = true;           ///< false: no pose arrived; forces must fall to zero
  std::uint32_t switches = 0;  ///< bit i: switch i is pressed
  /// Keeps it, or gives it back.
  void archive(Archive& a) {
    a("pose", pose);
    a("twist", twist);
    a("acceleration", acceleration);
    a("valid", valid);
    a("switches", switches);
  }
};

/// From the times of a recording to the scene's: t = scale * t_file + offset.
struct RecordingClock {
  double scale = 1.0;   ///< seconds per unit of the file's times
  double offset = 0.0;  ///< [s]
  /// As the scene says.  @throws Error for a scale that is not positive or an offset that is not finite
  static RecordingClock of(const DeviceSpec& spec);
  /// @param t_file  in the file's units  @returns the scene's time [s]
  double operator()(double t_file) const { return scale * t_file + offset; }
};

/// A span of time [s].
struct TimeSpan {
  double first = 0.0, last = 0.0;  ///< both within it
};

/// Which poses and speeds a handle may have: others are a fault of whoever sent them.
struct PoseBounds {
  Vec3 center = Vec3::Zero();                    ///< [m]
  double radius = HUGE_VAL;                      ///< of the ball about it that holds each handle [m]
  double speed = HUGE_VAL, rotation = HUGE_VAL;  ///< largest [m/s, rad/s]
  /// Whether a handle may be and move like that.
  bool hold(const Pose& pose, const Twist& twist) const;
};

/// A haptic device: something that a hand holds, whose pose is read and which gives a wrench back.
///
/// Axes are the scene's for every quantity; a device with axes of its own turns them before they come here.
/// The loop calls `sample` once or more a tick, with times that do not decrease (at the same time it gives
/// the same sample), and then `feedback` with the wrench that the hand feels until the next one.
/// The first sample opens the device; the destructor of each device lets go of whatever it holds.
///
/// A device of one's own overrides `do_sample` and, where it has motors, `do_feedback`; see docs/devices.md.
class Device {
 public:
  Device() = default;
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Takes hold of the hardware, socket or file; nothing where it is open.  @throws Error where it cannot
  void open();
  /// Motors off, and lets go; nothing where it is closed.
  void close();
  /// Whether it holds what it works with.
  bool is_open() const { return open_; }

  /// The handle at time t [s]; opens the device where it is closed.  @throws Error where it cannot be opened
  HandleSample sample(double t);
  /// @param t  time of the tick [s]
  /// @param on_hand  force [N] and moment about the handle's origin [N m] on the hand, scene's axes
  void feedback(double t, const Wrench& on_hand);
  /// `feedback` at the time of the last sample.
  void set_force_and_torque(const Vec3& force, const Vec3& torque) { feedback(time_, {torque, force}); }

  // of the last sample; at rest in the origin before the first
  Vec3 position() const { return last_.pose.translation; }       ///< [m]
  Quat rotation() const { return last_.pose.rotation; }          ///< handle's axes to the scene's
  Vec3 linear_velocity() const { return last_.twist.linear; }    ///< [m/s]
  Vec3 angular_velocity() const { return last_.twist.angular; }  ///< [rad/s]
  std::uint32_t switches() const { return last_.switches; }      ///< bit i: switch i is pressed

  /// What it can do; figures that nobody has measured are left out.
  virtual DeviceSpecification specification() const = 0;
  /// Its motion as a function of time, valid at any time, where that is known beforehand; empty where a hand
  /// decides as it goes.  One integrator of tool and bodies needs it.
  virtual std::function<HandleSample(double t)> path() const { return {}; }

  /// When its motion was recorded, by the scene's clock; empty where it is none of a recording.
  virtual std::optional<TimeSpan> recorded() const { return {}; }

  /// Whether somebody outside of this program moves it, by the wall's clock: it needs a run in real time.
  virtual bool is_live() const { return false; }
  /// What it has to wait for before a run, in words: "the first pose at ..."; empty: for nothing.
  virtual std::string awaited() const { return {}; }
  /// Opens the device and waits for that, before the clock starts.  Returns early where `stop` is set.
  /// @param t  time of the run's start [s]  @param stop  may be null
  /// @throws Error where it did not come in time
  void await(double t, const std::atomic<bool>* stop);
  /// From now on a pose outside of the bounds is dropped, by devices that cannot vouch for theirs.
  virtual void bound(const PoseBounds&) {}

  /// What it has counted, by name: packets that it dropped, for one.  Read when its loop is over.
  virtual std::vector<std::pair<std::string, long long>> tallies() const { return {}; }

  /// Whether it can go on later from where it is now: whether archive() knows all of it.  A hand on the other
  /// side of a network, or of a motor, does not wait.
  virtual bool can_be_archived() const { return false; }
  /// Keeps where it is, or goes on from there.
  /// @pre can_be_archived(); where it is given back, nothing was sampled before
  void archive(Archive& a);

 protected:
  /// Takes hold of what the device works with; nothing for devices without.  @throws Error where it cannot
  virtual void do_open() {}
  /// Lets go; called at most once for each do_open().  Must not throw.
  virtual void do_close() {}
  /// As await(), of a device that is open; nothing for those that wait for nobody.
  virtual void do_await(double /*t*/, const std::atomic<bool>* /*stop*/) {}
  /// The handle at time t [s], without waiting; `valid` is false while nothing new has come.
  virtual HandleSample do_sample(double t) = 0;
  /// The wrench from t [s] on, about the handle's origin, scene's axes; nothing for devices without motors.
  virtual void do_feedback(double /*t*/, const Wrench& /*on_hand*/) {}
  /// What it knows beside the last sample.
  virtual void do_archive(Archive&) {}

 private:
  HandleSample last_;
  double time_ = 0.0;  ///< of the last sample [s]
  bool open_ = false;
};

/// A device is one file in src/device and one entry here, with the keys of `[device]` that it alone uses;
/// what limits its force serves every device.
/// @param folder  where relative paths in the spec start: the scene's
using MakeDevice = std::unique_ptr<Device> (*)(const DeviceSpec& spec, const std::string& folder);
/// Devices by the name in `device.type`.
const Registry<MakeDevice>& device_registry();
/// The device that the spec names.  @throws Error for an unknown name and bad settings
std::unique_ptr<Device> make_device(const DeviceSpec& spec, const std::string& folder = {});

/// The path through keyframes: before the first and after the last it rests there.  Rotations interpolate on
/// the rotation vector between neighbours (about one fixed axis a segment), so twist and acceleration are the
/// exact derivatives of the pose.  At a keyframe's own time the segment that starts there counts.  A "step"
/// or a kink of "linear" has no derivative: the jump is in the pose or the twist alone.
/// @throws Error for an empty path
HandleSample sample_keyframes(const std::vector<KeyframeSpec>& keyframes, double t);

/// Checks a path: at least one keyframe, all finite, times strictly ascending, known interpolations, and
/// rotations of at most half a turn from one keyframe to the next (beyond that the way round is ambiguous).
/// @throws Error beginning with `where`, e.g. "device"
void check_keyframes(const std::vector<KeyframeSpec>& keyframes, const std::string& where);

}  // namespace palpate::device
