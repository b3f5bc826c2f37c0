#pragma once
#include "palpate/loop/load.h"

namespace palpate::live {

/// Small ball that a tool touches from above.
inline scene::Description small_scene(const std::vector<std::string>& overrides = {}) {
  return loop::parse(R"(
[scene]
name = "small ball"
duration_s = 0.1
[[body]]
name = "ball"
youngs_modulus_pa = 1e4
poissons_ratio = 0.4
stiffness_damping_s = 5e-3
mesh = { generator = "ball", radius_m = 0.03, element_size_m = 0.015 }
[[body.attachment]]
box_min_m = [-0.05, -0.05, -0.05]
box_max_m = [0.05, 0.05, -0.02]
[tool]
radius_m = 0.01
mass_kg = 0.01
position_m = [0.0, 0.0, 0.045]
[device]
type = "script"
[[device.keyframe]]
time_s = 0.0
position_m = [0.0, 0.0, 0.045]
[[contact]]
between = ["ball", "tool"]
stiffness_pa_m = 1e6
[exchange]
exchange_period_s = 0.01
[integrator]
name = "linearly-implicit-euler"
step_s = 0.01
)",
                     "small.toml", overrides);
}

/// A second hand beside the ball: overrides of small_scene().
inline const std::vector<std::string> kSecondHand = {
    "hand=[{name=\"left\",tool={radius_m=0.01,mass_kg=0.01,position_m=[-0.06,0.0,0.0]},"
    "device={type=\"script\",keyframe=[{time_s=0.0,position_m=[-0.06,0.0,0.0]}]}}]"};

}  // namespace palpate::live
