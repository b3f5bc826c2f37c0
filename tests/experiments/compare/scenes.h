#pragma once
#include <string>

#include "palpate/experiments/compare.h"
#include "palpate/loop/load.h"

namespace palpate::compare_scenes {

/// The table of a soft block of a few tetrahedra on its held lower face, 4 x 4 x 2 cm.
inline std::string body_text(double youngs_modulus_pa = 1e4) {
  return R"([[body]]
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
)";
}

/// The block under gravity: smooth and without contact, so that methods converge at their theoretical orders.
/// @param more  TOML text appended to the scene
inline std::string block_text(const std::string& more, const std::string& name = "block",
                              double youngs_modulus_pa = 1e4) {
  return "[scene]\nname = \"" + name + "\"\nduration_s = 0.05\ngravity_m_s2 = [3.0, 0.0, -9.81]\n" +
         body_text(youngs_modulus_pa) + "[record]\nstate_period_s = 0.01\n" + more;
}

/// A round tool above the block, which it touches where its centre is 35 mm high.
/// @param height  of the tool and of the handle at the start, "0.035" [m]
/// @param tool, coupling  further keys of their tables
/// @param more  TOML text appended to the scene: keyframes, [exchange], ...
inline std::string touch_text(const std::string& height, const std::string& tool, const std::string& coupling,
                              const std::string& more) {
  const std::string position = "position_m = [0.001, 0.002, " + height + "]\n";
  return "[scene]\nname = \"touch\"\nduration_s = 0.04\n" + body_text() + R"([[contact]]
between = ["block", "tool"]
stiffness_pa_m = 1e7
[tool]
radius_m = 0.015
mass_kg = 0.05
)" + position +
         tool + "[tool.coupling]\nstiffness_n_m = 300.0\ndamping_n_s_m = 4.0\n" + coupling +
         "[device]\ntype = \"script\"\n[[device.keyframe]]\ntime_s = 0.0\n" + position + more;
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

/// A tool on its coupling spring, without a body.
/// @param keyframes  of the hand after the first, which holds the tool where it is
inline scene::Description tool_alone(const std::string& keyframes) {
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
[exchange]
exchange_period_s = 0.01
[device]
type = "script"
[[device.keyframe]]
time_s = 0.0
position_m = [0.0, 0.0, 0.05]
)" + keyframes,
                     "tool.toml");
}

/// The tool is pulled aside and released by the hand.
inline scene::Description tool_only() {
  return tool_alone("[[device.keyframe]]\ntime_s = 0.03\nposition_m = [0.01, 0.0, 0.04]\n");
}

/// One run of each of two integrators, of which one has error control.
inline compare::CompareOptions quick() {
  compare::CompareOptions options;
  options.repeats = 1;
  options.integrators = {"linearly-implicit-euler", "cvode-bdf"};
  return options;
}

}  // namespace palpate::compare_scenes
