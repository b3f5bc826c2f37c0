#pragma once
#include "scene_run.h"

namespace palpate::stability {

/// Contact rows: a body thrown at an obstacle, and nothing else.  Theory in throw.cpp.
///
/// Period and duration [s], relative tolerance, height of the start [m].
inline constexpr double kThrowPeriod = 2e-3, kThrowDuration = 0.1, kThrowRtol = 1e-4, kThrowHeight = 1e-3;

/// `d`'s body at `speed` [m/s] downwards from kThrowHeight above z = 0, against `obstacle`.
scene::Description thrown_at(scene::Description d, const ObstacleSpec& obstacle, double speed,
                             double stiffness_pa_m);

Verdicts expect_thrown(const Lab& lab, const scene::Description& thrown);

/// Energy gains that theory allows a column.
GainBars throw_bars(const Column& column, const scene::Description& d);

}  // namespace palpate::stability
