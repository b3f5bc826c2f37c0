#include <cmath>
#include <limits>

#include "alive.h"
#include "core/clock.h"
#include "multirate_theory.h"
#include "scene_run.h"

// A million haptic ticks are 1000 s, a hundred thousand exchange periods of 10 ms, each with one query of the
// contact.
//
// Unloaded, the cube remains in place: rounding of eps per period, summed only in the worst case, 1e5
// eps = 2e-11 of its size. The same cube must move when it is released at a speed, to 1e-6 of its path
// (alive.h). Stages are solved to a fraction of rtol, and the remainder is proportional to it: with 1e-5 up
// to 2.8e-6 of the path (ark-dirk-sdirk534). It is released with 1e-6.
//   -> accurate
//   w H = 0.3 for its fastest mode, and light damping: within every explicit limit, including that of
//   two-stage methods, which have none on the imaginary axis but grow by y^4/8 per step, y = w H, less than
//   the damping beta w^2 H/2 dissipates.
//
// On an incline below the angle of friction, without anchors (friction_anchors), it creeps, because
// regularised friction is a damper at small speeds: mu p A v/v_r = weight along the plane gives v = v_r
// tan(a)/mu, a steady motion that every consistent method reproduces, and that is subtracted; the rest must
// be below 1e-4 of the creep. The run starts from the settled creep, computed by linearly implicit Euler:
// contact is closed and remains so, the motion is linear except for the last of settling, and stability
// follows from linear theory. (Closing of the contact is tested in another row: only algebraically stable
// methods create no energy there.)
// - A-stable, fixed or under error control.
//     -> accurate
// - Explicit methods under error control run at their stability limit, where the stiffest modes persist at
//   the size of the tolerance: d = rtol L in position, e = rtol c in speed (c the wave speed). Friction is
//   the product of pressure and speed, so this shifts the mean creep v by at most (d/p)(e/v) relative, p =
//   rho g L/k = 5e-5 m the depth at rest: rtol is 1e-5, which makes this 5e-5.
//     -> accurate
// - Explicit methods at fixed steps: the floor, k = 1e7 Pa/m under a quarter of the face, and an eighth of
//   the mass make w H = 6, beyond their imaginary limits (2 to 4): the energy must have grown to 1e3 of the
//   available energy.
//     -> error
// - Multi-rate: where the spectral radius of its step about the steady creep (multirate_theory.cpp) amplifies
//   rounding by 1e3 in the run:
//     -> grew, error
// - Statics has no creep: no force holds the cube along the plane; it must report this, or remain.
//
// Memory must not grow: less than 2 MiB from the hundredth period to the last.

namespace palpate::stability {
namespace {

constexpr double kPeriod = 0.01, kDuration = 1000.0, kRtol = 1e-5;
constexpr double kMovingRtol = 1e-6;  // For released bodies.
constexpr double kSize = 0.05;        // Edge of the cube [m].
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kFriction = 0.5, kSlope = 0.2, kRegularisation = 0.05;  // mu; tan a; v_r [m/s]
constexpr double kSettling = 2.0;                                        // [s]
constexpr double kGrown = 1e3;  // Amplification of rounding that counts as instability.

scene::Description on_a_floor(double slope) {
  scene::Description d = soft_cube();
  d.duration_s = kDuration;
  d.exchange.contact_refresh_s = kPeriod;
  d.obstacles.push_back(floor_plane());
  ContactSpec contact;
  contact.first = "cube";
  contact.second = "floor";
  contact.stiffness_pa_m = slope > 0.0 ? 1e7 : 1e3;
  d.bodies[0].youngs_modulus_pa = slope > 0.0 ? 1e5 : 1e2;
  if (slope > 0.0) {
    contact.friction = kFriction;
    contact.friction_regularisation_m_s = kRegularisation;
    contact.friction_anchors = false;
    contact.damping_pa_s_m = 1e5;
    d.gravity_m_s2 = 9.81 / std::sqrt(1.0 + slope * slope) * Vec3(slope, 0, -1);
  }
  d.contacts.push_back(contact);
  return d;
}

StabilityCell run(const CaseContext& context, double slope) {
  const double speed = kRegularisation * slope / kFriction;
  Settled start;
  if (slope > 0.0) start = settle(on_a_floor(slope), kSettling);
  Vec3 first = Vec3::Zero();
  double memory = 0.0, drift = 0.0;
  const auto probe = [&](loop::World& world, double t) {
    const Vec3 now = (world.positions(world.bodies[0]) - world.bodies[0].placed).rowwise().mean();
    if (t == 0.0 && slope > 0.0) first = now;
    if (memory == 0.0 && t >= 1.0 - 1e-9) memory = resident_memory_mib();
    drift = std::max(drift, (now - first - Vec3(speed * t, 0, 0)).norm());
  };
  const SceneCourse course =
      run_scene(context, on_a_floor(slope), kRtol, 10.0, probe, slope > 0.0 ? &start : nullptr);
  const double grown = resident_memory_mib() - memory,
               bar = slope > 0.0 ? 1e-4 * speed * kDuration : kDuration / kPeriod * kEps * kSize;
  StabilityCell cell;
  cell.steps = course.steps;
  cell.error = drift;
  cell.figure =
      fmt::format("drift {:.1e} m (limit {:.0e}) in excess of a creep of {:.1e} m, memory {:+.1f} MiB", drift,
                  bar, speed * kDuration, grown);
  std::string mistake;
  if (ended_early(context.column, course.result, course.finite, course.interrupted, drift > 1e3 * bar,
                  cell)) {
    if (cell.verdict == Verdict::kError && !(is_multirate(context.column) && drift > bar))
      mistake = gave_up_early(context, course);
  } else {
    cell.verdict = drift <= bar && grown < 2.0 ? Verdict::kAccurate : Verdict::kGrew;
    if (slope == 0.0) mistake = does_not_move(context, on_a_floor(slope), kMovingRtol);
  }
  mark_wrong(mistake, cell);
  return cell;
}

Verdicts expect(const CaseContext& context) {
  if (is_static(context.column)) return {Verdict::kAccurate, Verdict::kError};
  return {Verdict::kAccurate};
}

/// Returns the spectral radius of one step of a multi-rate method, linearised about the settled creep.
double amplification_on_slope(const Column& column) {
  scene::Description d = on_a_floor(kSlope);
  d.integrator.name = "linearly-implicit-euler";
  const auto world = loop::assemble(d);
  const Settled settled = settle(d, kSettling);
  return multirate_amplification_at(column, *world, settled.q, settled.u, kPeriod);
}

Verdicts expect_on_slope(const CaseContext& context) {
  if (is_explicit(context.column) && context.column.fixed) return {Verdict::kError};
  if (is_multirate(context.column) &&
      kDuration / kPeriod * std::log(amplification_on_slope(context.column)) > std::log(kGrown))
    return {Verdict::kGrew, Verdict::kError};
  return expect(context);
}

}  // namespace

Row million_ticks_row() {
  return {"million-ticks",
          "a cube on a floor for a million ticks (1000 s).  Detects drift, memory leaks, and creep that "
          "differs from the law's",
          RowColumns::kSteppers,
          true,
          {{"unloaded", expect, [](const CaseContext& context) { return run(context, 0.0); }},
           {"on an incline, held by friction", expect_on_slope,
            [](const CaseContext& context) { return run(context, kSlope); }}}};
}

}  // namespace palpate::stability
