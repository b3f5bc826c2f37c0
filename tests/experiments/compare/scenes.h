#pragma once
#include <string>

#include "palpate/experiments/compare.h"
#include "palpate/loop/load.h"

namespace palpate::compare_scenes {

/// A soft block of a few tetrahedra under gravity: smooth and without contact, so that methods converge at
/// their theoretical orders.
/// @param more  TOML text appended to the scene
inline std::string block_text(const std::string& more, const std::string& name = "block",
                              double youngs_modulus_pa = 1e4) {
  return "[scene]\nname = \"" + name + R"("
duration_s = 0.05
gravity_m_s2 = [3.0, 0.0, -9.81]
[[body]]
name = "block"
position_m = [0.0, 0.0, 0.01]
youngs_modulus_pa = )" +
         std::to_string(youngs_modulus_pa) + R"(
stiffness_damping_s = 2e-3
[body.mesh]
generator = "box"
size_m = [0.04, 0.04, 0.02]
element_size_m = 0.01
[[body.attachment]]
box_min_m = [-1.0, -1.0, -1e-6]
box_max_m = [1.0, 1.0, 1e-6]
[record]
state_period_s = 0.01
)" + more;
}

inline scene::Description block(const std::string& more, const std::string& name = "block",
                                double youngs_modulus_pa = 1e4) {
  return loop::parse(block_text(more, name, youngs_modulus_pa), name + ".toml");
}

inline const std::string kLadders = R"([[compare.ladder]]
integrator = "linearly-implicit-euler"
step_s = [4e-4, 2e-4, 1e-4]
[[compare.ladder]]
integrator = "cvode-bdf"
rtol = [1e-2, 1e-4, 1e-6]
)";

/// A tool on its coupling spring, pulled aside and released by the hand; no body.
inline scene::Description tool_only() {
  return loop::parse(R"([scene]
name = "tool alone"
duration_s = 0.04
[tool]
radius_m = 0.01
mass_kg = 0.05
position_m = [0.0, 0.0, 0.05]
[tool.coupling]
stiffness_n_m = 300.0
damping_n_s_m = 1.0
[device]
type = "script"
[[device.keyframe]]
time_s = 0.0
position_m = [0.0, 0.0, 0.05]
[[device.keyframe]]
time_s = 0.03
position_m = [0.01, 0.0, 0.04]
[exchange]
exchange_period_s = 0.01
)",
                     "tool.toml");
}

/// One run of each of two integrators, of which one has error control.
inline compare::CompareOptions quick() {
  compare::CompareOptions options;
  options.repeats = 1;
  options.integrators = {"linearly-implicit-euler", "cvode-bdf"};
  return options;
}

}  // namespace palpate::compare_scenes
