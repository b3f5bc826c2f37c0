#include "palpate/loop/run.h"

#include "body_side.h"
#include "palpate/core/clock.h"
#include "palpate/core/workers.h"

namespace palpate::loop {

double period_of(const scene::Description& d) {
  if (d.tool && d.exchange.scheme != "monolithic") return d.exchange.exchange_period_s;
  if (!d.contacts.empty()) return d.exchange.contact_refresh_s;
  return d.record ? d.record->state_period_s : d.duration_s;
}

RunResult run(World& world, const RunOptions& options) {
  const workers::Count threads(world.description.integrator.threads);
  RunResult result;
  BodySide bodies(world, options, result);
  const double wall = wall_seconds(), cpu = cpu_seconds();
  if (options.real_time)
    run_in_real_time(world, bodies, options, result);
  else
    run_in_virtual_time(world, bodies, options, result);
  result.wall_s = wall_seconds() - wall;
  result.cpu_s = cpu_seconds() - cpu;
  bodies.finish();
  return result;
}

}  // namespace palpate::loop
