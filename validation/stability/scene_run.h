#pragma once
#include <functional>

#include "palpate/loop/run.h"
#include "row.h"

namespace palpate::stability {

/// Summary of a scene's run, on which a verdict is based.
struct SceneCourse {
  dynamics::StepResult result;
  double available = 0.0;  ///< Mechanical energy at the start, plus work done from outside [J].
  double highest = 0.0;    ///< Largest mechanical energy [J].
  double last = 0.0;       ///< Mechanical energy at the end [J].
  bool finite = true;      ///< Every state that the stepper reported as good is finite.
  bool interrupted = false;
  long steps = 0;
  loop::RunResult run;
  double gain() const { return (highest - available) / available; }
};

struct Settled {
  VecX q, u;
};

/// Called with the world after every period.
using Probe = std::function<void(loop::World&, double t)>;

/// Runs a scene with the column's method and the periods of the description; a fixed step is as long as the
/// period. A run at an explicit fixed step whose energy has exceeded `grown` times the available energy is
/// followed beyond its end, until it fails or has run a hundred times as long: a run that has begun to
/// overflow must report it.
/// @param context column and time limit of the cell
/// @param description scene to run; its integrator is replaced
/// @param rtol tolerance under error control
/// @param external_work_j  work of external forces
/// @param probe called after every period
/// @param start initial state, at time 0; null: as described
SceneCourse run_scene(const CaseContext& context, const scene::Description& description, double rtol,
                      double external_work_j, const Probe& probe = {}, const Settled* start = nullptr);

/// Returns positions and velocities of a scene after `duration_s` of linearly implicit Euler.
Settled settle(const scene::Description& description, double duration_s);

/// Largest energy gains that count as stable and as bounded.
struct GainBars {
  double stable, bounded;
};

/// Checks that an explicit fixed step has grown, or that error control has used up its steps, before a run
/// ends with an error. Returns the discrepancy; empty if there is none.
std::string gave_up_early(const CaseContext& context, const SceneCourse& course);

/// Sets the verdict on a run by its energy alone, and the cell's figures.
void judge(const CaseContext& context, const SceneCourse& course, const GainBars& bars, StabilityCell& cell);

/// Returns a soft (E = 1e5 Pa), slightly damped, free cube of 50 mm with its lower side at z = 0; 8 nodes.
scene::Description soft_cube();
ObstacleSpec floor_plane();

}  // namespace palpate::stability
