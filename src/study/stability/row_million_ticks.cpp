#include <cmath>

#include "palpate/core/clock.h"
#include "scene_run.h"

// A million haptic ticks are 1000 s, a hundred thousand exchange periods of 10 ms, each with its own query of the contact.
// Unloaded, the cube stays where it was put: rounding of eps a period, not summed but in the worst case, 1e5 eps = 2e-11 of its size     -> accurate
//   w H = 0.3 of its fastest mode, and light damping: within every explicit limit, that of the two-stage methods too, which have none on the imaginary axis but grow
//   by y^4/8 a step, y = w H, less than the damping beta w^2 H/2 takes.
// On an incline below the angle of friction it creeps, for regularised friction is a damper at small speeds: mu p A v/v_r = weight along the plane
//   gives v = v_r tan(a)/mu, a steady motion that every consistent method keeps.  That is subtracted from the first second on, when the cube has bent and
//   settled; the rest stays below 1e-4 of the creep.  v_r >= mu g H, so that a step from rest ends where friction is a damper: a method that takes its
//   tangent once a step would leap to and fro over a narrower regularisation and slide                                                -> accurate
// (statics has no creep: nothing holds the cube along the plane; it must say so, or stay).
// Memory must not grow: less than 2 MiB from the hundredth period to the last.

namespace palpate::study {
namespace {

constexpr double kPeriod = 0.01, kDuration = 1000.0, kRtol = 1e-4;
constexpr double kSize = 0.05;  // of the cube [m]
constexpr double kFriction = 0.5, kSlope = 0.2, kRegularisation = 0.05;  // tan a, v_r [m/s]

scene::Description on_a_floor(double slope) {
  scene::Description d = soft_cube();
  d.duration_s = kDuration;
  d.coupling.contact_refresh_s = kPeriod;
  d.obstacles.push_back(floor_plane());
  ContactSpec contact;
  contact.first = "cube";
  contact.second = "floor";
  contact.stiffness_pa_m = slope > 0.0 ? 1e7 : 1e3;
  d.bodies[0].youngs_modulus_pa = slope > 0.0 ? 1e5 : 1e2;
  if (slope > 0.0) {
    contact.friction = kFriction;
    contact.friction_regularisation_m_s = kRegularisation;
    contact.damping_pa_s_m = 1e5;
    d.gravity_m_s2 = 9.81 / std::sqrt(1.0 + slope * slope) * Vec3(slope, 0, -1);
  }
  d.contacts.push_back(contact);
  return d;
}

StabilityCell run(const Lab& lab, double slope) {
  const double speed = kRegularisation * slope / kFriction;
  Vec3 settled = Vec3::Zero();
  double begin = 0.0, memory = 0.0, drift = 0.0;
  const SceneCourse course = run_scene(lab, on_a_floor(slope), kRtol, 10.0, [&](loop::World& world, double t) {
    const Vec3 now = (world.positions(world.bodies[0]) - world.bodies[0].placed).rowwise().mean();
    if (memory == 0.0 && t >= 1.0 - 1e-9) {
      memory = resident_memory_mib();
      begin = t;
      settled = slope > 0.0 ? now : Vec3::Zero();
    }
    if (memory > 0.0) drift = std::max(drift, (now - settled - Vec3(speed * (t - begin), 0, 0)).norm());
  });
  const double grown = resident_memory_mib() - memory, bar = slope > 0.0 ? 1e-4 * speed * kDuration : 1e-11 * kSize;
  StabilityCell cell;
  cell.steps = course.steps;
  cell.error = drift;
  cell.figure = fmt::format("drift {:.1e} m of {:.0e} beside a creep of {:.1e} m, memory {:+.1f} MiB", drift, bar, speed * kDuration, grown);
  if (ended_early(lab.column, course.result, course.finite, course.interrupted, drift > 1e3 * bar, cell)) return cell;
  cell.verdict = drift <= bar && grown < 2.0 ? Verdict::kAccurate : Verdict::kGrew;
  return cell;
}

Verdicts expect(const Lab& lab) {
  if (is_static(lab.column)) return {Verdict::kAccurate, Verdict::kError};
  return {Verdict::kAccurate};
}

/// The floor, k = 1e7 Pa/m under a quarter of the face, and an eighth of the mass make w H = 6: beyond the imaginary stability limit (2 to 4) of the
/// explicit methods here.
Verdicts expect_on_slope(const Lab& lab) {
  if (is_explicit(lab.column) && lab.column.fixed) return {Verdict::kError};
  return expect(lab);
}

}  // namespace

Row million_ticks_row() {
  return {"million-ticks", "a cube on a floor for a million ticks (1000 s)", RowColumns::kSteppers, true,
          {{"unloaded", expect, [](const Lab& lab) { return run(lab, 0.0); }}, {"on an incline, held by friction", expect_on_slope, [](const Lab& lab) { return run(lab, kSlope); }}}};
}

}  // namespace palpate::study
