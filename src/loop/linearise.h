#pragma once
#include "palpate/loop/contact_record.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

/// The contact seen from the tool at the State's time and pose for the coming period (docs/design.md, 4.5):
/// `frozen`, `condensed` or `points` by the scene.
/// @param version  of the record to make  @param frozen_fallbacks  counts step matrices that had no factor
/// @param hand  whose tool, as scene::hands_of() counts them: it feels bodies that the others press as they
///   do now, on their way
ContactRecord linearise_contact(World& world, std::uint64_t version, double period_s, long& frozen_fallbacks,
                                std::size_t hand = 0);

}  // namespace palpate::loop
