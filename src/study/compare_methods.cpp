#include <algorithm>

#include "palpate/core/error.h"
#include "palpate/study/compare.h"

namespace palpate::study {
namespace {

scene::Description with_method(scene::Description d, const std::string& method) {
  for (ContactSpec& contact : d.contacts)
    if (contact.second == "tool") contact.method = method;
  return d;
}

/// The largest number of samples at one time.
class SampleCount : public loop::Observer {
 public:
  void period(loop::World& world, double) override { most = std::max(most, static_cast<long>(world.contact->samples().size())); }
  long most = 0;
};

}  // namespace

std::vector<MethodPoint> compare_contact_methods(const scene::Description& d, const std::atomic<bool>* stop) {
  std::vector<MethodPoint> out;
  Trajectory first;
  for (const std::string& method : d.compare.contact_methods) {
    const auto world = loop::assemble(with_method(d, method));
    if (!world->tool_frame) fail("scene \"{}\": [compare] contact_methods needs a [[contact]] with \"tool\"", d.name);
    TrajectoryRecorder recorder;
    SampleCount samples;
    loop::RunOptions options;
    options.duration_s = d.compare.duration_s;
    options.observers = {&recorder, &samples};
    options.stop = stop;
    const loop::RunResult result = loop::run(*world, options);
    if (result.stopped) break;
    if (!result.status.ok()) fail("scene \"{}\" with contact method \"{}\": {}", d.name, method, result.status.message);
    if (out.empty()) first = recorder.trajectory();
    MethodPoint point{method, distance(recorder.trajectory(), first), 0.0, samples.most, result.query_s, result.cpu_s};
    for (const Wrench& w : recorder.trajectory().device) point.peak_force_n = std::max(point.peak_force_n, w.force.norm());
    out.push_back(point);
  }
  return out;
}

}  // namespace palpate::study
