#pragma once
#include "palpate/loop/world.h"
#include "row.h"

namespace palpate::stability {

inline bool is_multirate(const Column& column) { return column.entry->traits.family == "multi-rate"; }

/// Spectral radius of a step of a multi-rate column on a world linearised at its state, with the contact
/// refreshed there.
/// @param q, u  state to linearise about; the world is left in it
double multirate_amplification_at(const Column& column, loop::World& world, const VecX& q, const VecX& u,
                                  double step_s);

}  // namespace palpate::stability
