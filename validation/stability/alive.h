#pragma once
#include <string>

#include "scene_run.h"

namespace palpate::stability {

/// A stepper that does nothing keeps a body at rest as well as any.  So what rests is let go a second time,
/// all of it at a speed v, and must be where v t is after each of ten periods, to 1e-6 of it: nothing acts on
/// it, for what it touches is taken away.  (Cash's SDIRK methods have a stage at -0.7 of a step, which would
/// find a body that leaves a floor still in it.)  What is missing of that; empty for nothing, and for
/// statics, which knows no speed.
/// @param d  without gravity
std::string does_not_move(const CaseContext& context, scene::Description d, double rtol);

}  // namespace palpate::stability
