#include <algorithm>
#include <array>

#include "core/clock.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "product/bench.h"

namespace palpate::bench {
namespace {

scene::Description beam(int cells_along, double step_s, int steps, const std::string& linear_solver) {
  scene::Description d;
  d.name = "bench fem";
  d.duration_s = steps * step_s;
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  SoftBodySpec body;
  body.name = "beam";
  body.mesh.generator = "box";
  body.mesh.size_m = Vec3(1.0, 0.25, 0.25);
  body.mesh.element_size_m = 1.0 / cells_along;
  body.youngs_modulus_pa = 1e6;
  body.poissons_ratio = 0.4;
  AttachmentSpec end;
  end.box_min_m = Vec3(-0.5 - 1e-6, -1, -1);
  end.box_max_m = Vec3(-0.5 + 1e-6, 1, 1);
  body.attachments.push_back(end);
  d.bodies.push_back(body);
  d.integrator.name = "linearly-implicit-euler";
  d.integrator.step_s = step_s;
  d.integrator.linear_solver = linear_solver;
  d.record.emplace();
  d.record->states = false;
  d.record->state_period_s = step_s;  // The loop's period: one step each.
  return d;
}

/// Records the differences of the stepper's cumulative times from one period to the next.
class StageTimes : public loop::Observer {
 public:
  void period(loop::World& world, double) override {
    const dynamics::StepperCounters& c = world.stepper->counters();
    const std::array<double, 5> now{c.force_s, c.tangent_s, c.solver.factor_s + c.solver.symbolic_s,
                                    c.solver.solve_s, wall_seconds()};
    for (std::size_t i = 0; i < now.size() && started_; ++i) stages_[i].push_back(1e3 * (now[i] - last_[i]));
    last_ = now;
    started_ = true;
  }
  /// Returns medians in ms, without the first step, which includes the symbolic analysis.
  double median(std::size_t stage) const {
    std::vector<double> times(stages_[stage].begin() + 1, stages_[stage].end());
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2),
                     times.end());
    return times[times.size() / 2];
  }

 private:
  std::array<double, 5> last_{};
  std::array<std::vector<double>, 5> stages_;
  bool started_ = false;
};

}  // namespace

FemBench bench_fem(int cells_along, double step_s, int steps, const std::string& linear_solver) {
  if (cells_along < 4 || steps < 3)
    fail("bench fem: {} cells along and {} steps; use at least 4 cells and 3 steps", cells_along, steps);
  const scene::Description d = beam(cells_along, step_s, steps, linear_solver);
  const double start = wall_seconds();
  const auto world = loop::assemble(d);
  FemBench out;
  out.assemble_s = wall_seconds() - start;
  StageTimes times;
  loop::RunOptions options;
  options.observers = {&times};
  const loop::RunResult result = loop::run(*world, options);
  if (!result.status.ok()) fail("bench fem: {}", result.status.message);
  out.integrator = d.integrator.name;
  out.step_s = step_s;
  out.steps = steps;
  out.nodes = static_cast<int>(world->bodies[0].rest.nodes.cols());
  out.tetrahedra = static_cast<int>(world->bodies[0].rest.tets.cols());
  out.force_ms = times.median(0);
  out.tangent_ms = times.median(1);
  out.factor_ms = times.median(2);
  out.solve_ms = times.median(3);
  out.step_ms = times.median(4);
  out.other_ms = out.step_ms - out.force_ms - out.tangent_ms - out.factor_ms - out.solve_ms;
  out.peak_mib = peak_memory_mib();
  return out;
}

}  // namespace palpate::bench
