#pragma once
#include <string>
#include <vector>

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

}  // namespace palpate
