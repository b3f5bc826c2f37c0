#pragma once
#include "loop/small_scenes.h"

namespace palpate::tool_in_step {

/// A tool presses beside the centre of a block and slides, in steps of a tick.
inline scene::Description pressed(double shift = 0.004) {
  scene::Description d = small_scenes::pressed_block(0.0);
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  d.exchange.contact_refresh_s = d.exchange.exchange_period_s = d.integrator.step_s = 1e-3;
  d.bodies[0].mesh.element_size_m = 0.005;
  d.contacts[0].damping_pa_s_m = 1e4;
  ToolSpec& tool = *d.tool;
  tool.position_m.x() += shift;
  tool.coupling.rotational_stiffness_n_m_rad = 0.1;
  tool.coupling.rotational_damping_n_m_s_rad = 1e-3;
  d.device->keyframes[0].position_m = tool.position_m;
  KeyframeSpec end = d.device->keyframes[0];
  end.time_s = 0.03;
  end.position_m += Vec3(0.004, -0.003, -0.006);
  end.rotation_vector_rad = Vec3(0.3, -0.2, 0.5);
  d.device->keyframes.push_back(end);
  d.duration_s = 0.04;
  return d;
}

}  // namespace palpate::tool_in_step
