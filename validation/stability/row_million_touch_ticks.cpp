#include <cmath>

#include "core/clock.h"
#include "palpate/tool/tool.h"
#include "tool_scene.h"

// A million ticks of tool and body together: a ball on its coupling rests on a soft cube that is held below,
// with the handle pressed in by a fixed depth. The press ends after a second; from then on only rounding
// causes motion, and any drift is due to the exchange: a record that is not reproducible, a stiffness added
// or lost by a linearisation, ticks that drift along it. At rest the coupling carries the contact force, k
// (z_tool - z_handle) = F > 0, so the tool is away from the handle (it has touched), and
// - the tool is in the position after the press, to 1e-6 of the depth;
// - so is the cube's energy, to 1e-6;
// - memory does not grow: less than 2 MiB.
//   -> accurate
//
// The loop performs the ticks, for any steps of the cube; so the row has one representative method per
// family.

namespace palpate::stability {
namespace {

constexpr double kDuration = 1000.0, kSettled = 10.0, kDepth = 0.003, kRtol = 1e-4, kStays = 1e-6;

scene::Description pressed() {
  const double above = kToolCubeEdge + kToolRadius;
  scene::Description d = under_a_tool({{0.0, above}, {1.0, above - kDepth}, {kDuration, above - kDepth}}, 0.1,
                                      VirtualCouplingSpec{}.stiffness_n_m, 4.0);
  d.bodies[0].youngs_modulus_pa = 1e4;
  d.bodies[0].stiffness_damping_s = 1e-2;
  d.duration_s = kDuration;
  return d;
}

StabilityCell press(const CaseContext& context) {
  const scene::Description d = pressed();
  double memory = 0.0, moved = 0.0, energy = 0.0, changed = 0.0, carried = 0.0;
  Vec3 rest = Vec3::Zero();
  const SceneCourse course = run_scene(context, d, kRtol, 1.0, [&](loop::World& world, double t) {
    const Vec3 tool = world.tool_pose().translation;
    const double now = world.bodies[0].term->energy(world.state.view());
    if (memory == 0.0 && t >= kSettled) {
      memory = resident_memory_mib();
      rest = tool;
      energy = now;
      carried = (tool - d.device->keyframes.back().position_m).z();
    }
    if (memory == 0.0) return;
    moved = std::max(moved, (tool - rest).norm() / kDepth);
    changed = std::max(changed, std::abs(now / energy - 1.0));
  });
  const double grown = resident_memory_mib() - memory;
  StabilityCell cell;
  cell.steps = course.steps;
  cell.error = moved;
  cell.figure =
      fmt::format("tool moved {:.1e} of its depth, energy {:.1e}, carried {:.1e} m, memory {:+.1f} MiB",
                  moved, changed, carried, grown);
  if (ended_early(context.column, course.result, course.finite && std::isfinite(moved + changed),
                  course.interrupted, moved > 1.0, cell))
    return cell;
  if (!(carried > 0.01 * kDepth && energy > 0.0)) {
    cell.verdict = Verdict::kWrong;
    cell.reason = "the tool does not rest on the cube";
    return cell;
  }
  cell.verdict = moved <= kStays && changed <= kStays && grown < 2.0 ? Verdict::kAccurate : Verdict::kGrew;
  return cell;
}

Verdicts expect(const CaseContext&) { return {Verdict::kAccurate}; }

}  // namespace

Row million_touch_ticks_row() {
  if (!tool::available())
    return {"million-touch-ticks", "requires tools, which were not compiled in", RowColumns::kFamilies, true};
  Row row{"million-touch-ticks",
          "a million ticks of a tool that rests on a soft cube.  Detects drift of the exchange and memory "
          "leaks",
          RowColumns::kFamilies, true};
  row.cases.push_back({"at rest under a press", expect, press});
  return row;
}

}  // namespace palpate::stability
