#include "palpate/loop/run.h"

#include <cmath>

#include "body_loop.h"
#include "core/clock.h"
#include "palpate/core/error.h"
#include "palpate/core/workers.h"
#include "real_time_run.h"
#include "single_rate_real_time.h"
#include "virtual_time.h"

namespace palpate::loop {

RunResult run(World& world, const RunOptions& options) {
  if (!options.real_time && std::isinf(options.duration_s))
    fail("duration_s = inf: a run without an end needs the wall clock; run in real time (--realtime)");
  const workers::Count threads(world.description.integrator.threads);
  RunResult result;
  BodyLoop bodies(world, options, result);
  const double wall = wall_seconds(), cpu = cpu_seconds();
  if (options.real_time && world.description.exchange.scheme == scene::ExchangeScheme::kSingleRate)
    run_single_rate_in_real_time(world, bodies, options, result);
  else if (options.real_time)
    run_in_real_time(world, bodies, options, result);
  else
    run_in_virtual_time(world, bodies, options, result);
  result.wall_s = wall_seconds() - wall;
  result.cpu_s = cpu_seconds() - cpu;
  bodies.finish();
  return result;
}

}  // namespace palpate::loop
