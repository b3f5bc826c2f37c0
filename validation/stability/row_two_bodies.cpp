#include <cmath>

#include "palpate/core/error.h"
#include "throw.h"

// Two soft cubes, one above the other, densities rho and D rho, D up to 1e6; the upper, light one is thrown
// at the other, which is at rest and free. Without gravity and support, contact is the only force between
// them, and it balances, so
//     m1 v1 + m2 v2 = m1 v
// at every period, for any method: a linear invariant, which every method here conserves to rounding, to the
// remainder of Newton's method, and to the steps' tolerance under error control; 1e-4 of m1 v. (Multi-rate
// and additive methods as well: each of their sides conserves it.) Energy is bounded as in throw.cpp, with
// the reduced mass m1 m2/(m1 + m2) on the contact. By the end the light cube has reversed its motion
// (throw.cpp), relative to the heavy one:
//     v1 - v2 >= -0.05 v    (v > 0 away from it),
// and it has touched: v1 has changed by v/2 at least (with equal masses a perfectly plastic impact changes it
// by v/2, with a heavier second body by more). Energy as in throw.cpp: stable, bounded. E is proportional to
// the density, so that both have the same wave speed: otherwise the heavy cube would not move as one body in
// the row's time.

namespace palpate::stability {
namespace {

constexpr double kSpeed = 0.5, kMomentum = 1e-4, kEdge = 0.05, kGap = 2.5 * kSpeed * kThrowPeriod;

scene::Description light_on_heavy(double ratio) {
  scene::Description d = soft_cube();
  d.name = "two cubes";
  SoftBodySpec heavy = d.bodies[0];
  heavy.name = "heavy";
  heavy.density_kg_m3 *= ratio;
  heavy.youngs_modulus_pa *= ratio;
  d.bodies[0].position_m = Vec3(0.003, 0.002, 1.5 * kEdge + kGap);
  d.bodies[0].velocity_m_s = Vec3(0, 0, -kSpeed);
  d.bodies.push_back(heavy);
  ContactSpec contact;
  contact.first = d.bodies[0].name;
  contact.second = heavy.name;
  contact.stiffness_pa_m = 1e6;
  d.contacts.push_back(contact);
  d.exchange.contact_refresh_s = kThrowPeriod;
  d.duration_s = kThrowDuration;
  return d;
}

/// Returns momentum [kg m/s] and speed [m/s] along z of a body.
std::pair<double, double> motion_of(const loop::World& world, const loop::Body& body) {
  const dynamics::Block* block = world.state.layout().find(body.block_id);
  const Eigen::Map<const Points> v(world.state.u().data() + block->u_offset, 3, block->u_size / 3);
  const double p = (v * body.masses)[2];
  return {p, p / body.masses.sum()};
}

StabilityCell run(const CaseContext& context, const scene::Description& d) {
  double off = 0.0, first = 0.0, second = 0.0;
  const SceneCourse course = run_scene(context, d, kThrowRtol, 0.0, [&](loop::World& world, double) {
    const auto [p1, v1] = motion_of(world, world.bodies[0]);
    const auto [p2, v2] = motion_of(world, world.bodies[1]);
    const double thrown = -kSpeed * world.bodies[0].masses.sum();
    off = std::max(off, std::abs((p1 + p2) / thrown - 1.0));
    first = v1, second = v2;
  });
  StabilityCell cell;
  judge(context, course, throw_bars(context.column, d), cell);
  cell.figure += fmt::format(", momentum error {:.0e}, separates at {:+.2f} of its speed", off,
                             (first - second) / kSpeed);
  std::string mistake;
  if (cell.verdict == Verdict::kError) mistake = gave_up_early(context, course);
  if (cell.verdict <= Verdict::kBounded && !is_static(context.column)) {
    if (!(off <= kMomentum))
      mistake = fmt::format("the relative error of the momentum is {:.1e}", off);
    else if (!(first + kSpeed >= 0.45 * kSpeed))
      mistake = "the first body was not stopped";
    else if (!(first - second >= -0.05 * kSpeed))
      mistake = "the first body was not reversed";
  }
  mark_wrong(mistake, cell);
  return cell;
}

}  // namespace

Row two_bodies_row() {
  Row row{
      "two-bodies",
      "a soft cube thrown at one that is up to 1e6 times as dense, both free.  Detects unbalanced contact, "
      "momentum gained or lost by a method, and bodies that do not separate"};
  for (const double ratio : {1.0, 1e3, 1e6}) {
    const scene::Description d = light_on_heavy(ratio);
    row.cases.push_back({fmt::format("{:g} times as dense", ratio),
                         [d](const CaseContext& context) { return expect_thrown(context, d); },
                         [d](const CaseContext& context) { return run(context, d); }});
  }
  row.core = 2;
  return row;
}

}  // namespace palpate::stability
