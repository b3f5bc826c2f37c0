#pragma once
#include "palpate/dynamics/exchange.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

/// The contact seen from the tool at the State's time and pose, linear for the coming period
/// (docs/design.md, 4.5): `frozen` or `condensed` by the scene.
/// @param version  of the record to make  @param frozen_fallbacks  counts condensations that had no factor
dynamics::LinearisedContact linearise_contact(World& world, std::uint64_t version, double period_s,
                                              long& frozen_fallbacks);

/// That record and the contact of the tool with obstacles, which no body answers: linear about the tool as it
/// is now, so at each tick.
dynamics::LinearisedContact with_obstacles(const World& world, const dynamics::LinearisedContact& record);

}  // namespace palpate::loop
