#include "scene_run.h"

#include <cmath>

#include "palpate/core/error.h"

namespace palpate::stability {
namespace {

constexpr double kGrownSpeed = 1e3, kFollow = 100.0;

/// Observer that records the energy during a run, and ends the run.
class Watch : public loop::Observer {
 public:
  Watch(const CaseContext& context, SceneCourse& course, double duration, double external_work_j,
        const Probe& probe)
      : context_(context),
        course_(course),
        duration_(duration),
        external_work_j_(external_work_j),
        probe_(probe) {}
  void period(loop::World& world, double t) override {
    const double energy = world.mechanical_energy();
    if (t == 0.0) course_.available = energy + external_work_j_;
    course_.finite =
        course_.finite && std::isfinite(energy) && world.state.q().allFinite() && world.state.u().allFinite();
    course_.highest = std::max(course_.highest, energy);
    course_.last = energy;
    course_.interrupted = context_.time_is_up();
    if (probe_) probe_(world, t);
    const bool growing = context_.column.entry && context_.column.fixed && is_explicit(context_.column) &&
                         course_.highest > kGrownSpeed * course_.available;
    if (course_.interrupted || !course_.finite || (t >= duration_ * (1.0 - 1e-9) && !growing)) stop_ = true;
  }
  const std::atomic<bool>* stop() const { return &stop_; }

 private:
  const CaseContext& context_;
  SceneCourse& course_;
  double duration_, external_work_j_;
  const Probe& probe_;
  std::atomic<bool> stop_{false};
};

}  // namespace

Settled settle(const scene::Description& description, double duration_s) {
  scene::Description d = description;
  d.duration_s = duration_s;
  d.integrator = {};
  d.integrator.name = "linearly-implicit-euler";
  const auto world = loop::assemble(d);
  const loop::RunResult run = loop::run(*world, {});
  PALPATE_CHECK(run.status.ok(), "the scene did not settle: {}", run.status.message);
  return {world->state.q(), world->state.u()};
}

SceneCourse run_scene(const CaseContext& context, const scene::Description& description, double rtol,
                      double external_work_j, const Probe& probe, const Settled* start) {
  scene::Description d = description;
  d.integrator = {};
  // Only for assembly, replaced afterwards: a column need not be in the registry.
  d.integrator.name = "linearly-implicit-euler";
  const auto world = loop::assemble(d);
  if (start) {
    world->state.q() = start->q;
    world->state.u() = start->u;
  }
  if (context.column.entry && world->stepper) {
    world->description.integrator = spec_of(context.column, rtol, loop::period_of(d));
    world->stepper = make_stepper(context.column, world->system, world->state, world->description.integrator);
    world->stepper->set_interrupt(context.expired);
  }
  SceneCourse course;
  Watch watch(context, course, d.duration_s, external_work_j, probe);
  loop::RunOptions options;
  options.duration_s = kFollow * d.duration_s;
  options.observers = {&watch};
  options.stop = watch.stop();
  course.run = loop::run(*world, options);
  course.result = course.run.status;
  if (course.result.status == dynamics::StepStatus::kInterrupted) course.interrupted = true;
  if (world->stepper) course.steps = world->stepper->counters().steps;
  return course;
}

std::string gave_up_early(const CaseContext& context, const SceneCourse& course) {
  if (is_static(context.column)) return {};
  if (context.column.fixed && is_explicit(context.column))
    return course.gain() > kGrownSpeed ? std::string()
                                       : fmt::format("stopped at {:.1e} of the energy", 1.0 + course.gain());
  if (!context.column.fixed)
    return course.steps >= kMaxSteps ? std::string() : fmt::format("stopped after {} steps", course.steps);
  return "stopped";
}

void judge(const CaseContext& context, const SceneCourse& course, const GainBars& bars, StabilityCell& cell) {
  cell.steps = course.steps;
  cell.gain = course.gain();
  cell.figure = fmt::format("energy {:+.1e}", cell.gain);
  if (ended_early(context.column, course.result, course.finite, course.interrupted, cell.gain > bars.bounded,
                  cell))
    return;
  cell.verdict = cell.gain <= bars.stable    ? Verdict::kStable
                 : cell.gain <= bars.bounded ? Verdict::kBounded
                                             : Verdict::kGrew;
}

scene::Description soft_cube() {
  scene::Description d;
  d.name = "soft cube";
  SoftBodySpec body;
  body.name = "cube";
  body.mesh.generator = "box";
  body.mesh.size_m = Vec3::Constant(0.05);
  body.mesh.element_size_m = 0.05;
  body.position_m = Vec3(0, 0, 0.025);
  body.youngs_modulus_pa = 1e5;
  body.stiffness_damping_s = 1e-3;
  d.bodies.push_back(body);
  d.record.emplace();
  d.record->state_period_s = 0.01;  // The loop's period if no other part specifies one.
  return d;
}

ObstacleSpec floor_plane() {
  ObstacleSpec floor;
  floor.name = "floor";
  floor.type = "plane";
  return floor;
}

}  // namespace palpate::stability
