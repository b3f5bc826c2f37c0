#include "palpate/bench/contact.h"

#include <algorithm>
#include <cmath>

#include "palpate/contact/contact_force.h"
#include "palpate/core/clock.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"

namespace palpate::bench {
namespace {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size()))) - 1;
  return values[std::min(at, values.size() - 1)];
}
double median(const std::vector<double>& values) { return quantile(values, 0.5); }

Spread spread_of(const std::vector<double>& values) {
  return {quantile(values, 1e-9), median(values), quantile(values, 0.99)};
}

/// Cumulative times [s] and counts after a period.
struct Times {
  double wall = 0, query = 0, positions = 0, regions = 0, patches = 0, images = 0, gaps = 0, solve = 0;
  long image_count = 0;
};

/// What each period took; what the observer does itself is not counted.
class Watch : public loop::Observer {
 public:
  Watch() { before_.wall = wall_seconds(); }

  void period(loop::World& world, double) override {
    const Times now = times_of(world);
    contact::ContactForce& contact = *world.contact;
    const dynamics::StateView state = world.state.view();
    force_.setZero(state.layout->u_size);
    const double start = wall_seconds();
    contact.add_force(state, force_);
    const double forced = wall_seconds();
    if (!force_.isZero(0.0)) keep(world, now, forced - start);
    before_ = now;
    before_.wall = wall_seconds();
  }

  std::vector<double> query, positions, regions, patches, images, gaps, rest, solve, whole, force, tangent,
      samples, image_counts;

 private:
  Times times_of(loop::World& world) const {
    Times t;
    t.wall = wall_seconds();
    t.query = world.contact->query_seconds();
    for (const contact::QueryStages* s : world.contact->stages()) {
      if (!s) continue;
      t.positions += s->positions_s;
      t.regions += s->regions_s;
      t.patches += s->patches_s;
      t.images += s->images_s;
      t.gaps += s->gaps_s;
      t.image_count += s->images;
    }
    const dynamics::StepperCounters& c = world.stepper->counters();
    t.solve = c.solver.factor_s + c.solver.symbolic_s + c.solver.solve_s;
    return t;
  }

  void keep(loop::World& world, const Times& now, double force_s) {
    const auto add = [&](std::vector<double>& to, double Times::*of) {
      to.push_back(1e3 * (now.*of - before_.*of));
    };
    add(whole, &Times::wall);
    add(query, &Times::query);
    add(positions, &Times::positions);
    add(regions, &Times::regions);
    add(patches, &Times::patches);
    add(images, &Times::images);
    add(gaps, &Times::gaps);
    add(solve, &Times::solve);
    rest.push_back(query.back() - positions.back() - regions.back() - patches.back() - images.back() -
                   gaps.back());
    force.push_back(1e3 * force_s);
    samples.push_back(static_cast<double>(world.contact->samples().size()));
    image_counts.push_back(static_cast<double>(now.image_count - before_.image_count));
    const dynamics::StateView state = world.state.view();
    if (world.contact->pattern_version() != pattern_) {
      world.system.step_matrix(state, 1.0, 0.0, 0.0, matrix_);
      pattern_ = world.contact->pattern_version();
    }
    const double start = wall_seconds();
    world.contact->add_tangent(state, 1e-4, 1e-2, matrix_);
    tangent.push_back(1e3 * (wall_seconds() - start));
  }

  Times before_;
  VecX force_;
  dynamics::BorderedMatrix matrix_;
  std::uint64_t pattern_ = 0;
};

}  // namespace

ContactBenchRow bench_contact(scene::Description d, const ContactBenchVariant& variant,
                              const std::atomic<bool>* stop) {
  bool any = false;
  for (ContactSpec& contact : d.contacts) {
    const bool obstacle = std::any_of(d.obstacles.begin(), d.obstacles.end(),
                                      [&](const ObstacleSpec& o) { return o.name == contact.second; });
    if (obstacle) continue;
    contact.method = variant.method;
    if (variant.pixels > 0) {
      contact.pixels = variant.pixels;
      contact.quadrature_error = 0.0;
    }
    any = true;
  }
  if (!any)
    fail(
        "bench contact: scene \"{}\" has nothing to see in an image: no contact with a tool or between "
        "bodies",
        d.name);
  d.integrator.threads = variant.threads;
  d.record.reset();
  const auto world = loop::assemble(d);
  ContactBenchRow out;
  out.variant = variant;
  out.period_s = loop::period_of(d);
  for (const loop::Body& body : world->bodies) {
    out.tetrahedra += static_cast<int>(body.rest.tets.cols());
    out.skin_vertices +=
        static_cast<int>(body.skin ? body.skin->rest.vertices.cols() : body.boundary.surface.vertices.cols());
  }
  Watch watch;
  loop::RunOptions options;
  options.observers = {&watch};
  options.stop = stop;
  const loop::RunResult result = loop::run(*world, options);
  if (!result.status.ok()) fail("bench contact: {}", result.status.message);
  if (watch.whole.empty()) fail("bench contact: in scene \"{}\" nothing touches", d.name);
  out.periods = static_cast<int>(watch.whole.size());
  out.query = spread_of(watch.query);
  out.period = spread_of(watch.whole);
  out.positions_ms = median(watch.positions);
  out.regions_ms = median(watch.regions);
  out.patches_ms = median(watch.patches);
  out.images_ms = median(watch.images);
  out.gaps_ms = median(watch.gaps);
  out.grouping_ms = median(watch.rest);
  out.force_ms = median(watch.force);
  out.tangent_ms = median(watch.tangent);
  out.linearise_ms = 1e3 * result.linearise_s / static_cast<double>(result.periods);
  out.solve_ms = median(watch.solve);
  out.samples = static_cast<long>(median(watch.samples));
  out.images = static_cast<long>(median(watch.image_counts));
  return out;
}

}  // namespace palpate::bench
