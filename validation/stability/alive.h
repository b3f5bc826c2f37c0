#pragma once
#include <string>

#include "scene_run.h"

namespace palpate::stability {

/// Checks that a stepper moves bodies, as a stepper that does nothing keeps a body at rest as well as any
/// other. The body is released a second time, with all nodes at a speed v and without the bodies that it
/// touched, so that no force acts on it; after each of ten periods it must be at v t to a relative 1e-6.
/// (Cash's SDIRK methods have a stage at -0.7 of a step, at which a body that leaves a floor would still be
/// in it.) Returns the discrepancy; empty if there is none, and for statics, which has no speeds.
/// @param d scene without gravity
std::string does_not_move(const CaseContext& context, scene::Description d, double rtol);

}  // namespace palpate::stability
