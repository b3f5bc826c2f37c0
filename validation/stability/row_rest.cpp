#include <cmath>

#include "alive.h"
#include "palpate/fem/soft_body.h"
#include "palpate/mesh/generators.h"

// At rest without load every right-hand side is zero except for rounding of the rotations, eps E x (face
// area) per node, which moves no node farther than eps times the body's size against its stiffness: a
// thousand times this, 1e-12 of the size, is the limit, for every method.
//   -> accurate
// (Soft enough, w H < 1, for every explicit limit: beyond it rounding grows as any other perturbation.) Only
// explicit methods may let it grow where rounding becomes a force in a rotated body: under error control the
// error is too small to be detected, so steps lengthen past the stability limit until rounding has grown to
// the tolerance; and at a fixed step a Runge-Kutta method of order 2 has |R(iy)|^2 = 1 + y^4/4 > 1 on every
// undamped mode, at any step.
//   -> accurate, bounded
// A stepper that does nothing stays at rest as well. So each cell releases its body a second time, at a speed
// v away from the floor: it must be at v t, to a relative 1e-6 (the internal force remains zero), or the cell
// is wrong. (Statics has no speed.)
//
// Free fall of one tetrahedron from rest, z = -g t^2/2, with zero internal force:
// - order 1 at a fixed step H (all of them: the error per step is g H^2/2): relative error H/T exactly;
// - order >= 2, one-step: exact for quadratics; multistep: its first step has order 1, and this one
//   error of g H^2/2 is propagated: at most H/T as well;
// - error control: the sum of the errors allowed in its steps, taken as 100 rtol;
// - statics: no force holds the body, the matrix is singular: this must be reported.
//     -> error
//
// No body: time advances. A stepper that only advances time does this as well, so the cell also lets an
// element fall.

namespace palpate::stability {
namespace {

constexpr double kRest = 1e-12, kRtol = 1e-6;
constexpr double kSoft = 1e3;  // [Pa]

double moved(const loop::World& world) {
  double most = 0.0;
  for (const loop::Body& body : world.bodies)
    most = std::max(most, (world.positions(body) - body.placed).cwiseAbs().maxCoeff());
  return most;
}

Verdicts expect_rest(const CaseContext& context) {
  // A free body: its matrix is singular.
  if (is_static(context.column)) return {Verdict::kAccurate, Verdict::kError};
  if (is_explicit(context.column)) return {Verdict::kAccurate, Verdict::kBounded};
  return {Verdict::kAccurate};
}

StabilityCell stays(const CaseContext& context, const scene::Description& d) {
  StabilityCell cell;
  double most = 0.0;
  const SceneCourse course = run_scene(
      context, d, kRtol, 1.0, [&](loop::World& world, double) { most = std::max(most, moved(world)); });
  cell.steps = course.steps;
  cell.error = most / d.bodies[0].mesh.size_m.norm();
  cell.figure = fmt::format("moved {:.1e} of its size", cell.error);
  if (ended_early(context.column, course.result, course.finite, course.interrupted, cell.error > 0.1, cell))
    return cell;
  cell.verdict = cell.error <= kRest  ? Verdict::kAccurate
                 : cell.error <= 1e-6 ? Verdict::kBounded
                                      : Verdict::kGrew;
  mark_wrong(does_not_move(context, d, kRtol), cell);
  return cell;
}

scene::Description resting(bool rotated, bool floor) {
  scene::Description d = soft_cube();
  d.duration_s = 10.0;
  d.bodies[0].youngs_modulus_pa = kSoft;
  d.exchange.contact_refresh_s = 0.01;
  if (rotated) d.bodies[0].rotation_vector_rad = Vec3(0.3, -0.7, 0.4);
  if (!floor) return d;
  d.obstacles.push_back(floor_plane());
  ContactSpec contact;
  contact.first = "cube";
  contact.second = "floor";
  contact.stiffness_pa_m = 1e4;
  d.contacts.push_back(contact);
  return d;
}

constexpr double kG = 9.81, kH = 0.01, kFall = 0.4;

double bar_of_fall(const Column& column) {
  if (!column.fixed) return 100.0 * kRtol;
  return 1e-9 +
         (column.entry->traits.order == 1 || column.entry->traits.multistep ? 1.0001 * kH / kFall : 0.0);
}

Verdicts expect_fall(const CaseContext& context) {
  if (is_static(context.column)) return {Verdict::kError};
  return {Verdict::kAccurate};
}

StabilityCell fall(const CaseContext& context) {
  scene::Description d;
  d.duration_s = kFall;
  d.gravity_m_s2 = Vec3(0, 0, -kG);
  SoftBodySpec body;
  body.name = "element";
  body.mesh.generator = "tet";
  body.mesh.size_m = Vec3(0.1, 0.1, 0.1);
  body.youngs_modulus_pa = kSoft;
  d.bodies.push_back(body);
  d.record.emplace();
  d.record->state_period_s = kH;
  StabilityCell cell;
  const SceneCourse course = run_scene(context, d, kRtol, 1.0, [&](loop::World& world, double t) {
    const Points shift = world.positions(world.bodies[0]) - world.bodies[0].placed;
    cell.error = std::max(
        std::isnan(cell.error) ? 0.0 : cell.error,
        (shift.colwise() - Vec3(0, 0, -0.5 * kG * t * t)).cwiseAbs().maxCoeff() / (0.5 * kG * kFall * kFall));
  });
  cell.steps = course.steps;
  const double bar = bar_of_fall(context.column);
  cell.figure = fmt::format("error of the path {:.1e} (limit {:.1e})", cell.error, bar);
  if (ended_early(context.column, course.result, course.finite, course.interrupted, cell.error > 0.1, cell))
    return cell;
  cell.verdict = cell.error <= bar   ? Verdict::kAccurate
                 : cell.error <= 0.1 ? Verdict::kBounded
                                     : Verdict::kGrew;
  return cell;
}

StabilityCell nothing(const CaseContext& context) {
  StabilityCell cell;
  dynamics::State state;
  dynamics::System system;
  system.prepare(state.view());
  const auto stepper = make_stepper(context.column, system, state, spec_of(context.column, kRtol, kH));
  const dynamics::StepResult result = stepper->advance_to(1.0);
  cell.figure = fmt::format("time {:g} of 1 s", state.time());
  if (ended_early(context.column, result, std::isfinite(state.time()), false, false, cell)) return cell;
  cell.error = std::abs(state.time() - 1.0);
  cell.verdict = state.time() == 1.0 ? Verdict::kAccurate : Verdict::kGrew;
  if (is_static(context.column) || fall(context).verdict == Verdict::kAccurate) return cell;
  cell.verdict = Verdict::kWrong;
  cell.reason = "time advances, but an element does not fall as required";
  return cell;
}

}  // namespace

Row rest_row() {
  return {"rest",
          "no gravity, everything at rest: it remains at rest to rounding, and moves when released with a "
          "velocity.  Detects forces due to rounding, and steppers that do nothing",
          RowColumns::kSteppers,
          false,
          {{"a free cube", expect_rest,
            [](const CaseContext& context) { return stays(context, resting(false, false)); }},
           {"a cube that is rotated", expect_rest,
            [](const CaseContext& context) { return stays(context, resting(true, false)); }},
           {"a cube that just touches a floor", expect_rest,
            [](const CaseContext& context) { return stays(context, resting(false, true)); }}}};
}

Row size_row() {
  return {"sizes",
          "one element falling, and no body.  Detects errors of the path, and unhandled sizes",
          RowColumns::kSteppers,
          false,
          {{"one element falls", expect_fall, fall},
           {"no body", [](const CaseContext&) { return Verdicts{Verdict::kAccurate}; }, nothing}}};
}

}  // namespace palpate::stability
