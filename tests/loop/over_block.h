#pragma once
#include "palpate/scene/description.h"

namespace palpate::small_scenes {

/// Adds a free second body over the held block, and contact of both every hundredth of a second.
inline void put_over_block(scene::Description& d, SoftBodySpec upper) {
  upper.name = "upper";
  upper.attachments.clear();
  d.bodies.push_back(upper);
  ContactSpec contact;
  contact.first = "block";
  contact.second = "upper";
  contact.method = "distance";
  contact.stiffness_pa_m = 1e6;
  d.contacts.push_back(contact);
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.01;
}

}  // namespace palpate::small_scenes
