#pragma once
#include "small_scenes.h"

/// Scenes of 0.3 s in which a hand presses down.
namespace palpate::pressing_hand {

/// A hand that presses the block, 10 ticks to an exchange.
inline scene::Description scene_of(int latency_ticks = 0) {
  scene::Description d = small_scenes::pressed_block(0.0);
  d.duration_s = 0.3;
  KeyframeSpec down = d.device->keyframes.front();
  down.time_s = 0.2;
  down.position_m.z() -= 0.008;
  d.device->keyframes.push_back(down);
  d.exchange.latency_ticks = latency_ticks;
  return d;
}

/// A single ball, held 1 mm in the floor by a hand.
inline scene::Description ball_on_floor() {
  scene::Description d = scene_of();
  d.bodies.clear();
  small_scenes::add_floor(d, d.contacts.front());
  d.contacts.erase(d.contacts.begin());
  d.contacts.front().first = "tool";
  d.contacts.front().stiffness_pa_m = 1e8;
  d.tool->position_m = Vec3(0, 0, d.tool->radius_m);
  for (KeyframeSpec& k : d.device->keyframes) k.position_m = d.tool->position_m + Vec3(0, 0, -2e-3);
  return d;
}

}  // namespace palpate::pressing_hand
