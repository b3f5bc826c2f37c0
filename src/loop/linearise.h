#pragma once
#include "loop/contact_record.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

/// Linearises contact for a tool at the State's time and pose, for the next period
/// (docs/theory/haptic-loop.md): `frozen`, `condensed` or `points`, as the scene specifies.
/// @param version  version of the record  @param frozen_fallbacks  incremented if the step matrix has no
/// factor
/// @param hand  hand of the tool, in the numbering of scene::hands_of(); other tools continue with their
/// current twists
ContactRecord linearise_contact(World& world, std::uint64_t version, double period_s, long& frozen_fallbacks,
                                std::size_t hand = 0);

}  // namespace palpate::loop
