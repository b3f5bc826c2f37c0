#pragma once
#include <string>
#include <vector>

#include "palpate/core/keys.h"
#include "palpate/core/types.h"

namespace palpate {

struct KeyframeSpec {
  double time_s = 0.0;
  Vec3 position_m = Vec3::Zero();
  Vec3 rotation_vector_rad = Vec3::Zero();
  /// towards this keyframe: "minimum_jerk" (quintic, at rest at each keyframe), "linear", "step"
  std::string interpolation = "minimum_jerk";
};

/// The `[device]` table of a scene.
struct DeviceSpec {
  std::string type = "script";
  std::vector<KeyframeSpec> keyframes;
  double max_force_n = 3.3;  ///< of a common desktop device
  double max_torque_n_m = 0.2;
  double ramp_s = 0.0;  ///< force ramps in from zero over this time at the start
};

/// What they may be: checked by the loader of scenes and by the limiter.
struct DeviceRanges {
  static constexpr Range max_force_n = Range::positive("a desktop device gives 3.3");
  static constexpr Range max_torque_n_m = Range::positive("a desktop device gives 0.2");
  static constexpr Range ramp_s = Range::at_least(0.0, "0 is no ramp");
};

}  // namespace palpate
