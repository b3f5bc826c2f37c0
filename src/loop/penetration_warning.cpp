#include "loop/penetration_warning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "loop/clearance.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "palpate/scene/load.h"

namespace palpate::loop {
namespace {

void warn_of_own_penetration(const PenetrationReport& o, double t) {
  log::warn(
      "contact {} at t = {:.6g} s: penetration reached {:.3g} mm; self-contact detects overlaps up to "
      "{:.3g} mm, and deeper points are not separated. Increase contact.stiffness_pa_m, or press less "
      "deeply",
      o.pair, t, 1e3 * o.deepest_m, 1e3 * o.half_width_m / PenetrationReport::kOwnShare);
}

void warn_of_penetration(const PenetrationReport& o, double t) {
  log::warn(
      "contact {} at t = {:.6g} s: penetration reached {:.3g} mm, more than half the thickness of the "
      "thinner side ({:.3g} mm): the two may pass through each other. Increase contact.stiffness_pa_m, "
      "decrease body.youngs_modulus_pa, or press less deeply",
      o.pair, t, 1e3 * o.deepest_m, 2e3 * o.half_width_m);
}

/// Returns the depth of an overlap of the two sides at the start; 0: none [m].
double overlap_at_start(const World& world, std::size_t contact) {
  const std::optional<Clearance> found = clearance_of(world, contact);
  return found ? std::max(0.0, -found->gap.distance) : 0.0;
}

}  // namespace

// Rejects a scene in which an object starts inside another: contact would push it out at the nearest side,
// with the full force at once.
void PenetrationWarning::reject_start(const World& world, std::size_t contact, const PenetrationReport& o) {
  rejected_start_ = true;
  const std::optional<Clearance> found = clearance_of(world, contact);
  const std::string what =
      found && found->gap.distance < 0.0
          ? overlap_text(*found)
          : fmt::format("the two overlap by {:.3g} mm at the start; separate them", 1e3 * o.deepest_m);
  fail("{}: contact {}: {}", scene::place_of(world.description, fmt::format("contact[{}]", contact)), o.pair,
       what);
}

// Called at each period and query: only numbers until a warning is due.  The limit of a contact is computed
// at its first touch.
void PenetrationWarning::check(const World& world, double t) {
  if (!world.contact) return;
  const std::size_t pairs = world.contact->pair_count();
  if (checked_to_.empty()) {
    checked_to_.assign(pairs, 0.0);
    for (std::size_t i = 0; t == 0.0 && i < pairs; ++i)
      if (starts_enclosed(world, i) && overlap_at_start(world, i) > penetration_limit(world, i))
        reject_start(world, i, penetration_report(world, i));
  }
  for (std::size_t i = 0; i < pairs; ++i) {
    if (!(world.contact->deepest(i) > checked_to_[i])) continue;
    checked_to_[i] = penetration_limit(world, i);
    if (!(world.contact->deepest(i) > checked_to_[i])) continue;
    checked_to_[i] = HUGE_VAL;
    const PenetrationReport o = penetration_report(world, i);
    if (t == 0.0 && !o.of_itself) reject_start(world, i, o);
    o.of_itself ? warn_of_own_penetration(o, t) : warn_of_penetration(o, t);
  }
}

}  // namespace palpate::loop
