#include <algorithm>
#include <cmath>

#include "bench/contact/assembly_times.h"
#include "bench/contact/query_bytes.h"
#include "bench/contact/statistics.h"
#include "palpate/bench/contact.h"
#include "palpate/contact/contact_force.h"
#include "palpate/core/clock.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"

namespace palpate::bench {
namespace {

/// Cumulative times [s] and counts after a period.
struct Times {
  double wall = 0, query = 0, positions = 0, regions = 0, patches = 0, images = 0, gaps = 0, solve = 0;
  long image_count = 0, pixels = 0, region_count = 0, faces = 0;
};

/// Times of the periods, one each [ms].
struct Periods {
  std::vector<double> query, positions, regions, patches, images, gaps, rest, solve, whole, step, force,
      tangent, samples, image_counts, region_counts, bytes, assembly, elements;
};

/// What each period took; what the observer does itself is not counted.
class Watch : public loop::Observer {
 public:
  explicit Watch(loop::World& world) : assembly_(world) {
    for (const loop::Body& body : world.bodies) nodes_ += static_cast<double>(body.rest.nodes.cols());
  }

  void period(loop::World& world, double) override {
    const Times now = times_of(world);
    // the first call is at the start of the run: its query is no period's
    if (started_) {
      const dynamics::StateView state = world.state.view();
      force_.setZero(state.layout->u_size);
      const double start = wall_seconds();
      world.contact->add_force(state, force_);
      const double forced = wall_seconds() - start;
      const bool touches = !force_.isZero(0.0);
      keep(world, now, forced, touches ? touching : apart);
    }
    started_ = true;
    before_ = now;
    before_.wall = wall_seconds();
  }

  Periods touching, apart;

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
      t.pixels += s->pixels;
    }
    for (const proxy::PruneCounts* p : world.contact->pruning()) {
      if (!p) continue;
      t.region_count += p->regions;
      t.faces += p->faces_a + p->faces_b;
    }
    const dynamics::StepperCounters& c = world.stepper->counters();
    t.solve = c.solver.factor_s + c.solver.symbolic_s + c.solver.solve_s;
    return t;
  }

  void keep(loop::World& world, const Times& now, double force_s, Periods& to) {
    const auto add = [&](std::vector<double>& list, double Times::*of) {
      list.push_back(1e3 * (now.*of - before_.*of));
    };
    const auto count = [&](long Times::*of) { return static_cast<double>(now.*of - before_.*of); };
    add(to.whole, &Times::wall);
    add(to.query, &Times::query);
    add(to.positions, &Times::positions);
    add(to.regions, &Times::regions);
    add(to.patches, &Times::patches);
    add(to.images, &Times::images);
    add(to.gaps, &Times::gaps);
    add(to.solve, &Times::solve);
    to.rest.push_back(to.query.back() - to.positions.back() - to.regions.back() - to.patches.back() -
                      to.images.back() - to.gaps.back());
    to.step.push_back(to.whole.back() - to.query.back());
    to.force.push_back(1e3 * force_s);
    to.samples.push_back(static_cast<double>(world.contact->sample_count()));
    to.image_counts.push_back(count(&Times::image_count));
    to.region_counts.push_back(count(&Times::region_count));
    to.bytes.push_back(query_bytes({.nodes = nodes_,
                                    .faces = count(&Times::faces),
                                    .pixels = count(&Times::pixels),
                                    .samples = to.samples.back()}));
    to.assembly.push_back(assembly_.contact_ms());
    to.elements.push_back(assembly_.elements_ms());
    const dynamics::StateView state = world.state.view();
    if (world.contact->pattern_version() != pattern_) {
      world.system.step_matrix(state, 1.0, 0.0, 0.0, matrix_);
      pattern_ = world.contact->pattern_version();
    }
    const double start = wall_seconds();
    world.contact->add_tangent(state, 1e-4, 1e-2, matrix_);
    to.tangent.push_back(1e3 * (wall_seconds() - start));
  }

  bool started_ = false;
  double nodes_ = 0.0;
  Times before_;
  VecX force_;
  AssemblyTimes assembly_;
  dynamics::BorderedMatrix matrix_;
  std::uint64_t pattern_ = 0;
};

void fill(ContactBenchRow& out, const Periods& of) {
  out.periods = static_cast<int>(of.whole.size());
  out.query = spread_of(of.query);
  out.period = spread_of(of.whole);
  out.step = spread_of(of.step);
  out.positions_ms = median(of.positions);
  out.regions_ms = median(of.regions);
  out.patches_ms = median(of.patches);
  out.images_ms = median(of.images);
  out.gaps_ms = median(of.gaps);
  out.grouping_ms = median(of.rest);
  out.force_ms = median(of.force);
  out.tangent_ms = median(of.tangent);
  out.solve_ms = median(of.solve);
  out.assembly_ms = median(of.assembly);
  out.elements_ms = median(of.elements);
  out.query_bytes = median(of.bytes);
  out.samples = static_cast<long>(median(of.samples));
  out.images = static_cast<long>(median(of.image_counts));
  for (const double regions : of.region_counts)
    out.regions += regions / static_cast<double>(of.region_counts.size());
}

/// Sets how the gaps of all contacts in image space are found; whether there is one.
bool set_variant(scene::Description& d, const ContactBenchVariant& variant) {
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
  return any;
}

}  // namespace

ContactBenchRow bench_contact(scene::Description d, const ContactBenchVariant& variant,
                              const std::atomic<bool>* stop) {
  if (!set_variant(d, variant))
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
  Watch watch(*world);
  loop::RunOptions options;
  options.observers = {&watch};
  options.stop = stop;
  const loop::RunResult result = loop::run(*world, options);
  if (!result.status.ok()) fail("bench contact: {}", result.status.message);
  out.touches = !watch.touching.whole.empty();
  fill(out, out.touches ? watch.touching : watch.apart);
  out.linearise_ms = 1e3 * result.linearise_s / static_cast<double>(std::max(1L, result.periods));
  return out;
}

}  // namespace palpate::bench
