#pragma once
#include "scene_run.h"

namespace palpate::stability {

/// Contact rows: a body thrown at an obstacle, and nothing else.  Theory in throw.cpp.
///
/// Period and duration [s], relative tolerance.
inline constexpr double kThrowPeriod = 2e-3, kThrowDuration = 0.1, kThrowRtol = 1e-4;

/// `d`'s body at `speed` [m/s] downwards from 2.5 periods of flight above z = 0, against `obstacle`.
scene::Description thrown_at(scene::Description d, const ObstacleSpec& obstacle, double speed,
                             double stiffness_pa_m);

Verdicts expect_thrown(const CaseContext& context, const scene::Description& thrown);

/// Energy gains that theory allows a column.
GainBars throw_bars(const Column& column, const scene::Description& d);

/// Runs it, and judges energy, flight, turn and the reason of an early end.
/// @param probe  called after every period  @param passes  says whether the body went through the
///   obstacle, and so need not turn round; null: it cannot
StabilityCell projectile_case(const CaseContext& context, const scene::Description& thrown,
                              const Probe& probe = {}, const std::function<bool()>& passes = {});

}  // namespace palpate::stability
