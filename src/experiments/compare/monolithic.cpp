#include "experiments/compare/monolithic.h"

#include <algorithm>

#include "core/rounding.h"
#include "loop/replay.h"
#include "loop/run_figures.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"

namespace palpate::compare {
namespace {

Trajectory hand_series(const loop::HapticRecord& record) {
  WrenchRecorder recorder;
  for (const loop::TickRecord& tick : record.ticks) recorder.tick(tick);
  return recorder.trajectory();
}

/// Records the wrenches on each hand.
class EachHand : public loop::Observer {
 public:
  explicit EachHand(std::size_t hands) : of_(hands) {}
  void tick_of(std::size_t hand, const loop::TickRecord& tick) override { of_[hand].tick(tick); }
  const Trajectory& of(std::size_t hand) const { return of_[hand].trajectory(); }

 private:
  std::vector<WrenchRecorder> of_;
};

/// Size of the coordinates of a haptic scene, of which trajectories do not tell [m].
constexpr double kSceneSize = 1.0;

HandError hand_error(const Trajectory& felt, const Trajectory& reference) {
  HandError out;
  const loop::PeakWrench peak = loop::peak_of(reference.device, reference.tick_times);
  out.peak_force_n = peak.force_n;
  out.torque_rounding_n_m = torque_rounding(peak.force_n, kSceneSize);
  if (peak.torque_n_m > out.torque_rounding_n_m) out.peak_torque_n_m = peak.torque_n_m;
  out.error = wrench_distance(felt, reference);
  return out;
}

}  // namespace

void refuse_against_monolithic(const scene::Description& d) {
  if (!d.tool) fail("{}: there is no [tool], so there is no force on a hand to compare", d.path);
  if (d.bodies.empty())
    fail("{}: there is no [[body]], so nothing is exchanged; `palpate compare` compares tick periods",
         d.path);
  if (d.exchange.scheme == scene::ExchangeScheme::kMonolithic)
    fail("{}: exchange.scheme = \"monolithic\" is the reference itself; use \"partitioned\"", d.path);
}

namespace {

/// Simulates the reference and compares the forces of the run with it.
/// @param recorded_hand  whether the recorded hands replace those of the scene
AgainstReference against(const MonolithicScene& reference, bool recorded_hand,
                         const std::vector<loop::HapticRecord>& records,
                         const std::function<void(double)>& progress, const std::atomic<bool>* stop) {
  AgainstReference out;
  out.made_by = reference.made_by;
  out.recorded_hand = recorded_hand;
  try {
    if (records.empty() || records.front().ticks.empty()) fail("the run has no ticks");
    const auto world = recorded_hand ? loop::assemble(reference.description, loop::recorded_hands(records))
                                     : loop::assemble(reference.description);
    EachHand felt(records.size());
    loop::RunOptions options;
    options.duration_s = records.front().ticks.back().time;
    options.observers = {&felt};
    options.progress = progress;
    options.stop = stop;
    const loop::RunResult result = loop::run(*world, options);
    out.cpu_s = result.cpu_s;
    out.stopped = result.stopped;
    if (!result.status.ok())
      fail("{} failed at t = {:g} s: {}", reference.description.integrator.name, result.status.t,
           result.status.message);
    if (result.stopped) fail("stopped at t = {:g} s", result.time);
    static_cast<HandError&>(out) = hand_error(hand_series(records.front()), felt.of(0));
    for (std::size_t i = 1; i < records.size(); ++i)
      out.more_hands.push_back(hand_error(hand_series(records[i]), felt.of(i)));
  } catch (const Error& e) { out.trouble = e.what(); }
  return out;
}

}  // namespace

AgainstReference against_monolithic(const loop::World& run, const std::vector<loop::HapticRecord>& records,
                                    bool real_time, const std::function<void(double)>& progress,
                                    const std::atomic<bool>* stop) {
  refuse_against_monolithic(run.description);
  return against(monolithic_scene(run.description), real_time || !loop::all_paths_known(run), records,
                 progress, stop);
}

AgainstReference against_every_tick(const loop::World& run, const std::vector<loop::HapticRecord>& records,
                                    const std::function<void(double)>& progress,
                                    const std::atomic<bool>* stop) {
  return against({run.description, "the same scene in virtual time, which skips no tick"}, true, records,
                 progress, stop);
}

}  // namespace palpate::compare
