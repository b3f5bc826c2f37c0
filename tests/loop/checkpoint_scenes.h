#pragma once
#include <functional>
#include <string>
#include <vector>

#include "palpate/device/passivity.h"
#include "small_scenes.h"

/// Small scenes that together contain every piece of state stored in a checkpoint.
namespace palpate::checkpoint_scenes {

struct Case {
  scene::Description scene;
  double every_s = 0.0;
  bool energy = false;
  device::PassivityController::Mode passivity = device::PassivityController::Mode::kOff;
  /// Tolerance of a run's output: relative, and below `scale` absolute divided by scale.
  double restart_error = 1e-9, scale = 1e-3;
  std::size_t telling = 1;  ///< index of the checkpoint whose values are changed
};

/// A block under its weight, in which it is not in equilibrium.
inline Case falling_body(const std::string& integrator) {
  Case c{small_scenes::held_block(), 0.01};
  scene::Description& d = c.scene;
  d.bodies[0].mesh.element_size_m = 0.02;
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  d.integrator.name = integrator;
  d.integrator.step_s =
      integrator.starts_with("ark-erk") || integrator == "rk4" || integrator == "symplectic-euler" ? 2e-5
                                                                                                   : 5e-4;
  d.integrator.rtol = 1e-5;
  d.record.emplace();
  d.record->state_period_s = 0.002;
  return c;
}

std::vector<std::string> case_names();
Case find_case(const std::string& name);

}  // namespace palpate::checkpoint_scenes
