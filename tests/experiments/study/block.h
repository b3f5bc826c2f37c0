#pragma once
#include <string>

#include "experiments/study/plan.h"
#include "temporary_folder.h"

namespace palpate::study_scenes {

/// A soft block of a few tetrahedra that swings under its weight: milliseconds per run.
inline const std::string kBlock = R"([scene]
name = "block"
duration_s = 0.02
gravity_m_s2 = [0.0, 0.0, -9.81]
[[body]]
name = "block"
youngs_modulus_pa = 1e4
stiffness_damping_s = 2e-3
[body.mesh]
generator = "box"
size_m = [0.04, 0.04, 0.02]
element_size_m = 0.02
[[body.attachment]]
box_min_m = [-1.0, -1.0, -1.0]
box_max_m = [1.0, 1.0, -0.0099]
[integrator]
name = "linearly-implicit-euler"
step_s = 1e-3
)";

/// A study of block.toml in a separate folder.
/// @param study  [study] without its scenes, and what follows
inline study::Plan plan_of(const TemporaryFolder& folder, const std::string& study) {
  folder.write("block.toml", kBlock);
  const auto path = folder.write("my.toml", "[study]\nscenes = [\"block.toml\"]\n" + study);
  return study::list_tasks(scene::load_study(path.string()), {});
}

}  // namespace palpate::study_scenes
