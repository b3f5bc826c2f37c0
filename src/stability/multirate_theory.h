#pragma once
#include "palpate/loop/world.h"
#include "row.h"

namespace palpate::stability {

inline bool is_multirate(const Column& column) { return column.entry->traits.family == "multi-rate"; }

/// Spectral radius of a step of a multi-rate column on a world's linearisation at its state, contact
/// refreshed there.
/// @param q, u  where to linearise; the world is left there
double multirate_amplification_at(const Column& column, loop::World& world, const VecX& q, const VecX& u,
                                  double step_s);

}  // namespace palpate::stability
