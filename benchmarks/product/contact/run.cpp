#include <algorithm>
#include <cmath>
#include <string_view>
#include <type_traits>

#include "core/clock.h"
#include "palpate/contact/contact_force.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "product/contact.h"
#include "product/contact/assembly_times.h"
#include "product/contact/statistics.h"
#include "proxy/pruner.h"

namespace palpate::bench {
namespace {

/// Cumulative times [s] and counts after a period.
struct Times {
  double wall = 0.0, query = 0.0, solve = 0.0;
  std::array<double, kQueryStages> stages{};
  long images = 0, regions = 0;
};

/// Measurements with one entry per period; times in [ms].
struct Periods {
  std::vector<double> query, to_forces, solve, whole, step, samples, images, regions, assembly, elements;
  std::array<std::vector<double>, kContactStages> stages;
};

/// Records the times of each period, without the observer's work.
class Watch : public loop::Observer {
 public:
  explicit Watch(loop::World& world) : assembly_(world) {
    first_body_ = *world.state.layout().find(world.bodies.front().block_id);
  }

  void period(loop::World& world, double) override {
    const Times now = times_of(world);
    // The first call is at the start of the run: its query belongs to no period.
    if (started_) {
      const dynamics::StateView state = world.state.view();
      force_.setZero(state.layout->u_size);
      const double start = wall_seconds();
      world.contact->add_force(state, force_);
      const double forced = wall_seconds() - start;
      const bool touches = !force_.isZero(0.0);
      forces.push_back(
          Eigen::Map<const Points>(force_.data() + first_body_.u_offset, 3, first_body_.u_size / 3)
              .rowwise()
              .sum());
      keep(world, now, forced, touches ? touching : apart);
    }
    started_ = true;
    before_ = now;
    before_.wall = wall_seconds();
  }

  Periods touching, apart;
  std::vector<Vec3> forces;

 private:
  Times times_of(loop::World& world) const {
    Times t;
    t.wall = wall_seconds();
    t.query = world.contact->statistics().query_seconds;
    const auto add = [&](ContactStage stage, double seconds) {
      t.stages[static_cast<std::size_t>(stage)] += seconds;
    };
    for (const contact::PairReport& pair : world.contact->pairs()) {
      if (pair.pruning) t.regions += pair.pruning->regions;
      if (!pair.stages) continue;
      t.images += pair.stages->images;
      // The times are visited in the order of ContactStage, and images_s is the sum of the four after it.
      auto add_time = [&, stage = 0]<class T>(std::string_view name, const T& value) mutable {
        if constexpr (std::is_same_v<T, double>)
          if (name != "images_s") add(static_cast<ContactStage>(stage++), value);
      };
      contact::visit_counters(add_time, *pair.stages);
    }
    double known = 0.0;
    for (const double seconds : t.stages) known += seconds;
    add(ContactStage::kRest, t.query - known);
    const dynamics::StepperCounters& c = world.stepper->counters();
    t.solve = c.solver.factor_s + c.solver.symbolic_s + c.solver.solve_s;
    return t;
  }

  void keep(loop::World& world, const Times& now, double force_s, Periods& to) {
    const auto ms = [&](double Times::*of) { return 1e3 * (now.*of - before_.*of); };
    to.whole.push_back(ms(&Times::wall));
    to.query.push_back(ms(&Times::query));
    to.solve.push_back(ms(&Times::solve));
    to.to_forces.push_back(to.query.back() + 1e3 * force_s);
    to.step.push_back(to.whole.back() - to.query.back());
    for (std::size_t s = 0; s < kQueryStages; ++s)
      to.stages[s].push_back(1e3 * (now.stages[s] - before_.stages[s]));
    to.stages[static_cast<std::size_t>(ContactStage::kForces)].push_back(1e3 * force_s);
    to.samples.push_back(static_cast<double>(world.contact->samples().size()));
    to.images.push_back(static_cast<double>(now.images - before_.images));
    to.regions.push_back(static_cast<double>(now.regions - before_.regions));
    to.assembly.push_back(assembly_.contact_ms());
    to.elements.push_back(assembly_.elements_ms());
    const dynamics::StateView state = world.state.view();
    if (world.contact->pattern_version() != pattern_) {
      world.system.step_matrix(state, 1.0, 0.0, 0.0, matrix_);
      pattern_ = world.contact->pattern_version();
    }
    const double start = wall_seconds();
    world.contact->add_tangent(state, 1e-4, 1e-2, matrix_);
    to.stages[static_cast<std::size_t>(ContactStage::kTangent)].push_back(1e3 * (wall_seconds() - start));
  }

  bool started_ = false;
  dynamics::Block first_body_;
  Times before_;
  VecX force_;
  AssemblyTimes assembly_;
  dynamics::BorderedMatrix matrix_;
  std::uint64_t pattern_ = 0;
};

void fill(ContactBenchRow& out, const Periods& of) {
  out.periods = static_cast<int>(of.whole.size());
  out.query = spread_of(of.query);
  out.to_forces = spread_of(of.to_forces);
  out.period = spread_of(of.whole);
  out.step = spread_of(of.step);
  for (std::size_t s = 0; s < kContactStages; ++s) out.stages[s] = spread_of(of.stages[s]);
  out.solve_ms = median(of.solve);
  out.assembly_ms = median(of.assembly);
  out.elements_ms = median(of.elements);
  out.samples = static_cast<long>(median(of.samples));
  out.images = static_cast<long>(median(of.images));
  // Sums first: summing n times 8/n would round, and the mean would not be exactly 8.
  for (const double regions : of.regions) out.regions += regions;
  out.regions /= static_cast<double>(std::max<std::size_t>(1, of.regions.size()));
}

/// Sets the method of all contacts except with obstacles; returns whether there is one.
bool set_variant(scene::Description& d, const ContactBenchVariant& variant) {
  bool any = false;
  for (ContactSpec& contact : d.contacts) {
    const bool obstacle = std::any_of(d.obstacles.begin(), d.obstacles.end(),
                                      [&](const ObstacleSpec& o) { return o.name == contact.second; });
    if (obstacle || (variant.method == "image" && contact.first == contact.second)) continue;
    contact.method = variant.method;
    any = true;
  }
  return any;
}

}  // namespace

ContactBenchRow bench_contact(scene::Description d, const ContactBenchVariant& variant,
                              const std::atomic<bool>* stop) {
  if (!set_variant(d, variant))
    fail("bench contact: scene \"{}\" has no contact with a tool or between bodies", d.name);
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
  const ContactDevice device = device_of(variant.method);
  out.device = device.name;
  out.device_is_software = device.software;
  out.touches = !watch.touching.whole.empty();
  fill(out, out.touches ? watch.touching : watch.apart);
  out.left_out_n = world->contact->statistics().largest_friction_lag;
  out.friction_n = world->contact->statistics().largest_lagged_friction;
  out.forces = std::move(watch.forces);
  out.linearise_ms = 1e3 * result.linearise_s / static_cast<double>(std::max(1L, result.periods));
  return out;
}

}  // namespace palpate::bench
