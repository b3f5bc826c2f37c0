#include "experiments/compare/mesh_run.h"

#include <algorithm>

#include "core/clock.h"
#include "experiments/compare/run_archive.h"

namespace palpate::compare {
namespace {

/// Records the series of a run and its largest number of contact samples.
class SeriesRecorder : public loop::Observer {
 public:
  explicit SeriesRecorder(bool tool) : tool_(tool) {}

  void period(loop::World& world, double t) override {
    if (world.contact)
      most_samples = std::max(most_samples, static_cast<long>(world.contact->samples().size()));
    if (tool_) return;
    Vec3 largest = Vec3::Zero();
    for (const loop::Body& body : world.bodies) {
      const Points moved = world.positions(body) - body.placed;
      Eigen::Index node = 0;
      if (moved.colwise().squaredNorm().maxCoeff(&node) > largest.squaredNorm()) largest = moved.col(node);
    }
    add(t, largest);
  }
  void tick(const loop::TickRecord& tick) override {
    if (tool_) add(tick.time, tick.device.force);
  }

  std::vector<double> times;
  std::vector<Vec3> series;
  long most_samples = 0;

 private:
  void add(double t, const Vec3& value) {
    times.push_back(t);
    series.push_back(value);
  }

  bool tool_;
};

}  // namespace

void MeshRun::archive(Archive& a) {
  a("times", times);
  a("series", series);
  a("elements", elements);
  a("nodes", nodes);
  a("surface_vertices", surface_vertices);
  a("most_samples", most_samples);
  a("setup_s", setup_s);
  archive_result(a, result);
}

MeshRun run_for_mesh(const scene::Description& description, double duration_s,
                     const std::atomic<bool>* stop) {
  MeshRun out;
  const double start = thread_cpu_seconds();
  const auto world = loop::assemble(description);
  out.setup_s = thread_cpu_seconds() - start;
  for (const loop::Body& body : world->bodies) {
    out.elements += static_cast<long>(body.rest.tets.cols());
    out.nodes += static_cast<long>(body.rest.nodes.cols());
    out.surface_vertices += static_cast<long>(body.skin ? body.skin->rest.vertices.cols()
                                                        : body.boundary.surface.vertices.cols());
  }
  SeriesRecorder recorder(description.tool.has_value());
  loop::RunOptions options;
  options.duration_s = duration_s;
  options.observers = {&recorder};
  options.stop = stop;
  out.result = loop::run(*world, options);
  out.times = std::move(recorder.times);
  out.series.resize(3, static_cast<Eigen::Index>(recorder.series.size()));
  for (std::size_t i = 0; i < recorder.series.size(); ++i)
    out.series.col(static_cast<Eigen::Index>(i)) = recorder.series[i];
  out.most_samples = recorder.most_samples;
  return out;
}

}  // namespace palpate::compare
