#include "loop/penetration_warning.h"

#include <cmath>

#include "loop/penetration.h"
#include "palpate/core/log.h"

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
      "thinner side ({:.3g} mm): {}",
      o.pair, t, 1e3 * o.deepest_m, 2e3 * o.half_width_m,
      t == 0.0 ? "bodies that overlap at the start are pushed out at the nearest side, with the full force "
                 "at once. Separate the two in the scene"
               : "the two may pass through each other. Increase contact.stiffness_pa_m, decrease "
                 "body.youngs_modulus_pa, or press less deeply");
}

}  // namespace

// Called at each period and query: only numbers until a warning is due.  The limit of a contact is computed
// at its first touch.
void PenetrationWarning::check(const World& world, double t) {
  if (!world.contact) return;
  const std::size_t pairs = world.contact->pair_count();
  if (checked_to_.empty()) checked_to_.assign(pairs, 0.0);
  for (std::size_t i = 0; i < pairs; ++i) {
    if (!(world.contact->deepest(i) > checked_to_[i])) continue;
    checked_to_[i] = penetration_limit(world, i);
    if (!(world.contact->deepest(i) > checked_to_[i])) continue;
    checked_to_[i] = HUGE_VAL;
    const PenetrationReport o = penetration_report(world, i);
    o.of_itself ? warn_of_own_penetration(o, t) : warn_of_penetration(o, t);
  }
}

}  // namespace palpate::loop
