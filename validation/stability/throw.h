#pragma once
#include "scene_run.h"

namespace palpate::stability {

/// Contact rows: a body thrown at an obstacle, without other forces. Theory in throw.cpp.
///
/// Period and duration [s], relative tolerance.
inline constexpr double kThrowPeriod = 2e-3, kThrowDuration = 0.1, kThrowRtol = 1e-4;

/// Returns `d` with its body moving downwards at `speed` [m/s] from 2.5 periods of flight above z = 0,
/// against `obstacle`.
scene::Description thrown_at(scene::Description d, const ObstacleSpec& obstacle, double speed,
                             double stiffness_pa_m);

Verdicts expect_thrown(const CaseContext& context, const scene::Description& thrown);

/// Returns the energy gains that theory allows a column.
GainBars throw_bars(const Column& column, const scene::Description& d);

/// Runs the case, and judges energy, flight, reversal and the reason of an early end.
/// @param context column and time limit of the cell
/// @param thrown scene of the throw
/// @param probe called after every period
/// @param passes returns whether the body went through the obstacle, and so need not reverse; null: it cannot
StabilityCell projectile_case(const CaseContext& context, const scene::Description& thrown,
                              const Probe& probe = {}, const std::function<bool()>& passes = {});

}  // namespace palpate::stability
