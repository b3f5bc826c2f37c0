#pragma once
#include "palpate/loop/world.h"
#include "row.h"

namespace palpate::stability {

inline bool is_multirate(const Column& column) { return column.entry->traits.family == "multi-rate"; }

/// Returns the spectral radius of a step of a multi-rate column on a world linearised at a state, with the
/// contact refreshed there.
/// @param column multi-rate method
/// @param world remains in the state q, u
/// @param q positions to linearise about
/// @param u velocities to linearise about
/// @param step_s step [s]
double multirate_amplification_at(const Column& column, loop::World& world, const VecX& q, const VecX& u,
                                  double step_s);

}  // namespace palpate::stability
