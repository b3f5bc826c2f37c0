#include <algorithm>

#include "palpate/compare/haptic.h"
#include "palpate/core/error.h"
#include "palpate/loop/replay.h"

namespace palpate::compare {
namespace {

Trajectory felt_in(const loop::HapticRecord& record) {
  WrenchRecorder recorder;
  for (const loop::TickRecord& tick : record.ticks) recorder.tick(tick);
  return recorder.trajectory();
}

}  // namespace

void refuse_against_monolithic(const scene::Description& d) {
  if (!d.tool) fail("{}: there is no [tool]; nothing is felt that could be compared", d.path);
  if (d.bodies.empty())
    fail("{}: there is no [[body]]: nothing is exchanged; `palpate compare` compares the ticks", d.path);
  if (d.exchange.scheme == "monolithic")
    fail("{}: exchange.scheme = \"monolithic\" is the reference itself; take \"partitioned\"", d.path);
}

AgainstMonolithic against_monolithic(const loop::World& run, const loop::HapticRecord& record, bool real_time,
                                     const std::function<void(double)>& progress,
                                     const std::atomic<bool>* stop) {
  const scene::Description& d = run.description;
  refuse_against_monolithic(d);
  const MonolithicScene whole = monolithic_scene(d);
  AgainstMonolithic out;
  out.made_by = whole.made_by;
  out.recorded_hand = real_time || !device::make_device(*d.device, run.folder)->path();
  try {
    if (record.ticks.empty()) fail("the run has no ticks");
    const auto world = out.recorded_hand ? loop::assemble(whole.description, loop::recorded_hand(record))
                                         : loop::assemble(whole.description);
    WrenchRecorder recorder;
    loop::RunOptions options;
    options.duration_s = record.ticks.back().time;
    options.observers = {&recorder};
    options.progress = progress;
    options.stop = stop;
    const loop::RunResult result = loop::run(*world, options);
    out.cpu_s = result.cpu_s;
    out.stopped = result.stopped;
    if (!result.status.ok())
      fail("{} gave up at t = {:g} s: {}", whole.description.integrator.name, result.status.t,
           result.status.message);
    if (result.stopped) fail("stopped at t = {:g} s", result.time);
    for (const Wrench& w : recorder.trajectory().device) {
      out.peak_force_n = std::max(out.peak_force_n, w.force.norm());
      out.peak_torque_n_m = std::max(out.peak_torque_n_m, w.moment.norm());
    }
    out.error = wrench_distance(felt_in(record), recorder.trajectory());
  } catch (const Error& e) { out.trouble = e.what(); }
  return out;
}

}  // namespace palpate::compare
