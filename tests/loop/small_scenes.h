#pragma once
#include "palpate/scene/description.h"

namespace palpate::small_scenes {

/// A soft block of a few tetrahedra with its lower face held.
inline scene::Description held_block() {
  scene::Description d;
  d.name = "held block";
  d.duration_s = 0.04;
  SoftBodySpec body;
  body.name = "block";
  body.mesh.generator = "box";
  body.mesh.size_m = Vec3(0.04, 0.04, 0.02);
  body.mesh.element_size_m = 0.01;
  body.position_m = Vec3(0, 0, 0.01);
  body.youngs_modulus_pa = 1e4;
  body.stiffness_damping_s = 2e-3;
  AttachmentSpec floor;
  floor.box_min_m = Vec3(-1, -1, -1e-6);
  floor.box_max_m = Vec3(1, 1, 1e-6);
  body.attachments.push_back(floor);
  d.bodies.push_back(body);
  d.integrator.name = "linearly-implicit-euler";
  d.integrator.step_s = 0.01;
  return d;
}

/// Adds the plane z = 0, and contact of a body with it.
inline void add_floor(scene::Description& d, const ContactSpec& law) {
  ObstacleSpec floor;
  floor.name = "floor";
  floor.type = "plane";
  d.obstacles.push_back(floor);
  d.contacts.push_back(law);
  d.contacts.back().second = floor.name;
}

/// The held block under a round tool whose handle is `depth` below first touch.
inline scene::Description pressed_block(double depth) {
  scene::Description d = held_block();
  d.tool.emplace();
  d.tool->radius_m = 0.015;
  d.tool->mass_kg = 0.05;
  d.tool->position_m = Vec3(0.001, 0.002, 0.02 + 0.015 - depth);
  d.tool->coupling.stiffness_n_m = 300;
  d.tool->coupling.damping_n_s_m = 4;
  d.device.emplace();
  KeyframeSpec hold;
  hold.position_m = d.tool->position_m;
  d.device->keyframes.push_back(hold);
  ContactSpec contact;
  contact.first = "block";
  contact.second = "tool";
  contact.method = "analytic";  // linear between queries, so that linearisations are exact
  contact.stiffness_pa_m = 1e7;
  d.contacts.push_back(contact);
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.01;
  return d;
}

}  // namespace palpate::small_scenes
