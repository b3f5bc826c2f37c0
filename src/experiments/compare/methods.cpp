#include <algorithm>

#include "loop/run_figures.h"
#include "palpate/core/error.h"
#include "palpate/experiments/compare.h"

namespace palpate::compare {
namespace {

scene::Description with_method(scene::Description d, const std::string& method) {
  for (ContactSpec& contact : d.contacts) {
    if (contact.second != "tool") continue;
    contact.method = method;
  }
  return d;
}

/// Records the largest number of contact samples at one time.
class SampleCount : public loop::Observer {
 public:
  void period(loop::World& world, double) override {
    most = std::max(most, static_cast<long>(world.contact->samples().size()));
  }
  long most = 0;
};

/// Runs the scene with one method; returns false where it was stopped.
/// @throws Error where the method is not available or the run fails
bool run_method(const scene::Description& d, const std::string& method, const std::atomic<bool>* stop,
                Trajectory& trajectory, MethodPoint& point) {
  const auto world = loop::assemble(with_method(d, method));
  if (world->tool_frame_index() < 0) fail("there is no [[contact]] with \"tool\"");
  TrajectoryRecorder recorder;
  SampleCount samples;
  loop::RunOptions options;
  options.duration_s = d.compare.duration_s;
  options.observers = {&recorder, &samples};
  options.stop = stop;
  const loop::RunResult result = loop::run(*world, options);
  if (result.stopped) return false;
  if (!result.status.ok()) fail("{}", result.status.message);
  trajectory = recorder.trajectory();
  point.method = method;
  point.most_samples = samples.most;
  point.query_s = result.query_s;
  point.cpu_s = result.cpu_s;
  point.peak_force_n = loop::peak_of(trajectory.device, trajectory.tick_times).force_n;
  return true;
}

}  // namespace

std::vector<MethodPoint> compare_contact_methods(const scene::Description& d, const std::atomic<bool>* stop) {
  std::vector<MethodPoint> out;
  Trajectory first;
  for (const std::string& method : d.compare.contact_methods) try {
      Trajectory trajectory;
      MethodPoint point;
      if (!run_method(d, method, stop, trajectory, point)) break;
      if (first.period_times.empty()) first = trajectory;
      point.difference = distance(trajectory, first);
      out.push_back(point);
    } catch (const Error& e) {  // Earlier results are kept.
      MethodPoint point;
      point.method = method;
      point.trouble = e.what();
      out.push_back(point);
    }
  return out;
}

}  // namespace palpate::compare
