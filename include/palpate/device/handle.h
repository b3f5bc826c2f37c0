#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "palpate/core/pose.h"
#include "palpate/core/registry.h"
#include "palpate/device/spec.h"

namespace palpate::device {

/// The handle as the hand moves it at one instant.
struct HandleSample {
  Pose pose;
  Twist twist;
  Twist acceleration;  ///< [rad/s^2, m/s^2]
  bool valid = true;   ///< false: no pose arrived; forces must fall to zero
};

/// Something a hand holds.  `sample` is called once a tick with times that do not decrease; `feedback` gives
/// the wrench that the hand feels.
class Handle {
 public:
  virtual ~Handle() = default;
  virtual HandleSample sample(double t) = 0;
  virtual void feedback(double /*t*/, const Wrench& /*on_hand*/) {}
  /// Its motion as a function of time, valid at any time, where that is known beforehand; empty where a hand
  /// decides as it goes.  One integrator of tool and bodies needs it.
  virtual std::function<HandleSample(double t)> path() const { return {}; }
};

/// A device is one file in src/device and one entry here, with the keys of `[device]` that it alone uses;
/// what limits its force serves every device.
using MakeHandle = std::unique_ptr<Handle> (*)(const DeviceSpec&);
const Registry<MakeHandle>& handle_registry();
std::unique_ptr<Handle> make_handle(const DeviceSpec& spec);

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
