#include "tool_scene.h"

#include <algorithm>

namespace palpate::stability {

scene::Description under_a_tool(const std::vector<std::pair<double, double>>& heights, double mass,
                                double stiffness, double damping, double period) {
  scene::Description d = soft_cube();
  d.bodies[0].mesh.element_size_m = 0.5 * kToolCubeEdge;
  AttachmentSpec below;
  below.box_min_m = Vec3(-1, -1, -1e-6);
  below.box_max_m = Vec3(1, 1, 1e-6);
  d.bodies[0].attachments.push_back(below);
  d.tool.emplace();
  d.tool->radius_m = kToolRadius;
  d.tool->mass_kg = mass;
  d.tool->position_m = Vec3(0.001, 0.002, heights.front().second);
  d.tool->coupling.stiffness_n_m = stiffness;
  d.tool->coupling.damping_n_s_m = damping;
  d.device.emplace();
  for (const auto& [time, z] : heights) {
    KeyframeSpec frame;
    frame.time_s = time;
    frame.position_m = Vec3(0.001, 0.002, z);
    d.device->keyframes.push_back(frame);
  }
  ContactSpec contact;
  contact.first = "cube";
  contact.second = "tool";
  contact.stiffness_pa_m = 1e7;
  contact.quadrature_error = 0.1;  // The cell tests the method, not the accuracy of the force.
  d.contacts.push_back(contact);
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = period;
  d.tool->tick_s = std::min(1e-3, 0.2 * period);
  d.duration_s = heights.back().first + 0.1;
  return d;
}

}  // namespace palpate::stability
