#pragma once
#include "palpate/loop/contact_record.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

/// The contact seen from the tool at the State's time and pose for the coming period (docs/design.md, 4.5):
/// `frozen`, `condensed` or `points` by the scene.
/// @param version  of the record to make  @param frozen_fallbacks  counts step matrices that had no factor
ContactRecord linearise_contact(World& world, std::uint64_t version, double period_s, long& frozen_fallbacks);

}  // namespace palpate::loop
