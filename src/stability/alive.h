#pragma once
#include <string>

#include "scene_run.h"

namespace palpate::stability {

/// A stepper that does nothing keeps a body at rest as well as any.  So what rests is let go a second time,
/// all of it at a speed v upwards and aside, and must be where v t is after each of ten periods, to 1e-6 of
/// it: nothing acts on it.  What is missing of that; empty for nothing, and for statics, which knows no
/// speed.
/// @param d  without gravity, nothing above the body
std::string does_not_move(const Lab& lab, scene::Description d, double rtol);

}  // namespace palpate::stability
