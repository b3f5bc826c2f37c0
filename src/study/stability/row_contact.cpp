#include <cmath>

#include "scene_run.h"

// Thrown on a plane.  No gravity: what is available is the energy of the throw, E0 = 1/2 m v^2; the mechanical energy counts body and contact spring.
//   In continuous time it never rises (damping takes, and the gap of a plane with a fixed normal is conservative).
//   - Error control keeps to that within its tolerance, summed over the steps: with rtol 1e-4 and some hundred steps of relevance, 1e-2 E0
//                                                                                                                                     -> stable; error
//   - A fixed step H has no theorem for it.  Where the tangent is taken at the step's start, the contact is open there: the body flies on by v H into the plane, and
//     the spring then holds 1/2 k A (v H)^2, that is k A H^2/m times E0: 8e-8 k m/Pa E0 and so, at k = 1e12 Pa/m, far more than there was, to be given back as speed
//     or damped away, as the method does it.  Twice that and E0 once more (a second touch, a bending body) is the bound; more has no such reason.  Methods that
//     solve for the contact at the step's end do not need it.                                                                -> stable, bounded; error
//   - Explicit fixed steps beyond their limit are followed until they overflow, and must say so                                          -> the same set
// Statics: a free body has no equilibrium that the throw would end in: anything clear.

namespace palpate::study {
namespace {

constexpr double kPeriod = 2e-3, kDuration = 0.1, kRtol = 1e-4;
constexpr double kStable = 100.0 * kRtol;

Verdicts expect(const Lab& lab) {
  if (!lab.column.fixed && !is_static(lab.column)) return {Verdict::kStable, Verdict::kError};
  return {Verdict::kStable, Verdict::kBounded, Verdict::kError};
}

scene::Description thrown(scene::Description d, double speed, double stiffness) {
  d.duration_s = kDuration;
  d.bodies[0].position_m.z() += 1e-3;
  d.bodies[0].velocity_m_s = Vec3(0, 0, -speed);
  d.obstacles.push_back(floor_plane());
  ContactSpec contact;
  contact.first = d.bodies[0].name;
  contact.second = "floor";
  contact.stiffness_pa_m = stiffness;
  d.contacts.push_back(contact);
  d.coupling.contact_refresh_s = kPeriod;
  return d;
}

StabilityCell run(const Lab& lab, const scene::Description& d) {
  const SoftBodySpec& body = d.bodies[0];
  const double mass = body.density_kg_m3 * body.mesh.size_m.prod(), area = body.mesh.size_m.x() * body.mesh.size_m.y();
  const double one_step = d.contacts[0].stiffness_pa_m * area * kPeriod * kPeriod / mass;
  StabilityCell cell;
  judge(lab, run_scene(lab, d, kRtol, 0.0), {kStable, 1.0 + 2.0 * one_step}, cell);
  return cell;
}

scene::Description thin_slab() {
  scene::Description d = soft_cube();
  d.name = "thin slab";
  d.bodies[0].name = "slab";
  d.bodies[0].mesh.size_m = Vec3(0.1, 0.1, 0.005);
  d.bodies[0].mesh.element_size_m = 0.05;
  d.bodies[0].position_m = Vec3(0, 0, 0.0025);
  d.bodies[0].youngs_modulus_pa = 1e6;
  return d;
}

}  // namespace

Row contact_stiffness_row() {
  Row row{"contact-stiffness", "k from 1e2 to 1e12 Pa/m: a soft cube thrown on a plane at 0.5 m/s"};
  for (int decade = 2; decade <= 12; decade += 2)
    row.cases.push_back({fmt::format("k = 1e{} Pa/m", decade), expect, [decade](const Lab& lab) { return run(lab, thrown(soft_cube(), 0.5, std::pow(10.0, decade))); }});
  return row;
}

Row impact_row() {
  Row row{"impact", "a thin slab thrown on a plane, 0.1 to 100 m/s (up to three times the speed of its own waves)"};
  for (const double speed : {0.1, 1.0, 10.0, 100.0})
    row.cases.push_back({fmt::format("{:g} m/s", speed), expect, [speed](const Lab& lab) { return run(lab, thrown(thin_slab(), speed, 1e9)); }});
  return row;
}

}  // namespace palpate::study
