#include <fmt/format.h>

#include "palpate/core/error.h"
#include "product/contact.h"

namespace palpate::bench {
namespace {

/// Returns the contact of the scene's first body, applied to other bodies.
ContactSpec contact_between(const scene::Description& d, const std::string& first,
                            const std::string& second) {
  ContactSpec out = d.contacts.empty() ? ContactSpec{} : d.contacts.front();
  out.first = first;
  out.second = second;
  return out;
}

void leave_bodies_alone(scene::Description& d) {
  if (d.bodies.empty()) fail("bench contact: scene \"{}\" has no soft body", d.name);
  d.tool.reset();
  d.device.reset();
  d.obstacles.clear();
}

}  // namespace

scene::Description against_itself(scene::Description d) {
  leave_bodies_alone(d);
  d.name += ", the first body against itself";
  d.bodies.resize(1);
  d.contacts = {contact_between(d, d.bodies[0].name, d.bodies[0].name)};
  return d;
}

scene::Description row_of_bodies(scene::Description d, int count, double spacing_m) {
  if (count < 2) fail("bench contact: a row of {} bodies is too short; use at least 2", count);
  leave_bodies_alone(d);
  d.name += fmt::format(", {} in a row", count);
  const SoftBodySpec one = d.bodies.front();
  const ContactSpec law = contact_between(d, "", "");
  d.bodies.clear();
  d.contacts.clear();
  for (int k = 0; k < count; ++k) {
    SoftBodySpec body = one;
    body.name = fmt::format("{} {}", one.name, k + 1);
    body.position_m.x() += k * spacing_m;
    for (AttachmentSpec& held : body.attachments)
      for (Vec3* point : {&held.box_min_m, &held.box_max_m, &held.centre_m}) point->x() += k * spacing_m;
    d.bodies.push_back(body);
    if (k == 0) continue;
    d.contacts.push_back(law);
    d.contacts.back().first = d.bodies[static_cast<std::size_t>(k) - 1].name;
    d.contacts.back().second = body.name;
  }
  return d;
}

}  // namespace palpate::bench
