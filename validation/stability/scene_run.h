#pragma once
#include <functional>

#include "palpate/loop/run.h"
#include "row.h"

namespace palpate::stability {

/// Summary of a scene's run, on which a verdict is based.
struct SceneCourse {
  dynamics::StepResult result;
  double available = 0.0;  ///< mechanical energy at the start, plus what is put in from outside [J]
  double highest = 0.0;    ///< largest mechanical energy seen [J]
  double last = 0.0;       ///< at the end [J]
  bool finite = true;      ///< every state that the stepper reported as good
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

/// Runs a scene with the column's method, at the description's own periods; a fixed step is as long as the
/// period.  A run at an explicit fixed step whose energy has passed `grown` times the available energy is
/// followed beyond its end, until it fails or has gone on a hundred times as long: a run that has begun to
/// overflow must report it.
/// @param prepare_state  work done from outside [J]
/// @param start  where it starts from, at time 0; null: as described
SceneCourse run_scene(const CaseContext& context, const scene::Description& description, double rtol,
                      double prepare_state, const Probe& probe = {}, const Settled* start = nullptr);

/// Positions and velocities of a scene after `duration_s` of linearly implicit Euler.
Settled settle(const scene::Description& description, double duration_s);

/// Largest energy gains that count as stable and as bounded.
struct GainBars {
  double stable, bounded;
};

/// An explicit fixed step must have grown, error control must have used up its steps, before they end with an
/// error; what is missing of that, empty for nothing.
std::string gave_up_early(const CaseContext& context, const SceneCourse& course);

/// The verdict on a run by its energy alone; fills the cell's figures.
void judge(const CaseContext& context, const SceneCourse& course, const GainBars& bars, StabilityCell& cell);

/// A cube of 50 mm, soft (E = 1e5 Pa), a little damped, free, its lower side at z = 0; 8 nodes.
scene::Description soft_cube();
ObstacleSpec floor_plane();

}  // namespace palpate::stability
