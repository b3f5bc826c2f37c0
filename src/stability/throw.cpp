#include "throw.h"

#include <cmath>

#include "frequency.h"
#include "linear.h"
#include "multirate_theory.h"

// Thrown at an obstacle.  No gravity: what is available is the energy of the throw, E0 = 1/2 m v^2; the
// mechanical energy counts body and contact spring.  In continuous time it never rises: damping takes, the
// gap of a face with a fixed normal is conservative, and a vertex that is seen nearer to another face, or no
// longer inside, leaves the spring less.
// - Error control keeps to that within its tolerance, summed over the steps.  A step may err by rtol (atol_u
//   c + rms u) in speed, c = sqrt(E/rho) the scale of speeds (error_weights.h): of a body at speed v a
//   relative rtol max(1, atol_u c/v), and its energy by twice that at most; with some hundred steps of
//   relevance 1e-2 E0, and more of a body that is slower than a tenth of its own waves.
//     -> stable; error
// - A fixed step H has no theorem for it.  Where the tangent is taken at the step's start, the contact is
//   open there: the body flies on by v H into the plane, and the spring then holds
//       1/2 k A (v H)^2 = (k A H^2/m) E0 = (8e-8 k m/Pa) E0,
//   so at k = 1e12 Pa/m far more than there was, to be given back as velocity or damped away, depending on
//   the method.  Twice that and E0 once more (a second touch, a bending body) is the bound; there is no such
//   reason for more.  Methods that solve for the contact at the step's end do not need it.
//     -> stable, bounded; error
// - A multi-rate step has this flaw on its other side: within it the contact throws nodes about while the
//   elastic force is a given polynomial of time.  Nodes that move on by v H without an elastic reaction load
//   the springs between them by up to (w H)^2 E0, w the body's largest frequency.  Twice that is added to the
//   bound; but where the step's matrix with all of the lower side in contact has a spectral radius r above 1
//   (multirate_theory.cpp), each of the n steps of a touch multiplies the energy: where r^(2 n) > 2, n the
//   steps of the row, that is no bound.
//     -> stable, bounded, grew; error
// - Explicit fixed steps: a node on the contact alone is an oscillator of w_c^2 = k A_n/m_n, y = w_c H; one
//   step of s stages takes position times w_c and speed to at most P = 1 + y + ... + y^s/s! times themselves
//   (the majorant of its polynomial), their energy to P^2.  A touch is at most half a swing long, pi/y steps
//   and one that it begins in: P^(2n), n = 1 + ceil(pi/y), is the bound where it is more than the one above:
//   an explicit method may throw the body back so fast, and the body is then free.  What goes beyond a
//   thousand times E0 is followed until it overflows, and must say so.
//     -> stable, bounded; error
// - Statics: a free body has no equilibrium that the throw would end in: any end with a message is accepted.

namespace palpate::stability {
namespace {

/// Largest k A_n/m_n of the body's lower side [rad^2/s^2], A_n a third of the faces around the node.
double largest_contact_rate2(const loop::Body& body, double stiffness) {
  const TriMesh& surface = body.boundary.surface;
  VecX area = VecX::Zero(body.rest.nodes.cols());
  for (Eigen::Index f = 0; f < surface.faces.cols(); ++f) {
    const auto x = [&](int k) { return Vec3(surface.vertices.col(surface.faces(k, f))); };
    const double down = -0.5 * (x(1) - x(0)).cross(x(2) - x(0)).z();
    for (int k = 0; k < 3 && down > 0.0; ++k)
      area[body.boundary.node_of_vertex[static_cast<std::size_t>(surface.faces(k, f))]] += down / 3.0;
  }
  return stiffness * area.cwiseQuotient(body.masses).maxCoeff();
}

double explicit_gain(const Column& column, double rate) {
  const double y = rate * kThrowPeriod;
  const int stages = static_cast<int>(
      std::ceil(std::max(1.0, amplification(column, rate, 0.0, kThrowPeriod).evaluations) - 1e-9));
  double term = 1.0, P = 1.0;
  for (int j = 1; j <= stages; ++j) P += term *= y / j;
  return std::pow(P, 2.0 * (1.0 + std::ceil(M_PI / y))) - 1.0;
}

/// Factor that the energy may grow by with a multi-rate method while the whole lower side is in contact.
double growth_in_contact(const Column& column, scene::Description d) {
  constexpr double kDepth = 1e-6;
  d.integrator.name = "linearly-implicit-euler";
  const auto world = loop::assemble(d);
  VecX q = world->state.q();
  for (Eigen::Index i = 2; i < q.size(); i += 3) q[i] -= kThrowHeight + kDepth;
  const double r = multirate_amplification_at(column, *world, q, world->state.u(), kThrowPeriod);
  return std::pow(r, 2.0 * kThrowDuration / kThrowPeriod);
}

}  // namespace

scene::Description thrown_at(scene::Description d, const ObstacleSpec& obstacle, double speed,
                             double stiffness_pa_m) {
  d.duration_s = kThrowDuration;
  d.bodies[0].position_m.z() += kThrowHeight;
  d.bodies[0].velocity_m_s = Vec3(0, 0, -speed);
  d.obstacles.push_back(obstacle);
  ContactSpec contact;
  contact.first = d.bodies[0].name;
  contact.second = obstacle.name;
  contact.stiffness_pa_m = stiffness_pa_m;
  d.contacts.push_back(contact);
  d.exchange.contact_refresh_s = kThrowPeriod;
  return d;
}

Verdicts expect_thrown(const Lab& lab, const scene::Description& d) {
  if (is_multirate(lab.column) && growth_in_contact(lab.column, d) > 2.0)
    return {Verdict::kStable, Verdict::kBounded, Verdict::kGrew, Verdict::kError};
  if (!lab.column.fixed && !is_static(lab.column)) return {Verdict::kStable, Verdict::kError};
  return {Verdict::kStable, Verdict::kBounded, Verdict::kError};
}

GainBars throw_bars(const Column& column, const scene::Description& d) {
  const SoftBodySpec& spec = d.bodies[0];
  const double stiffness = d.contacts[0].stiffness_pa_m;
  const double mass = spec.density_kg_m3 * spec.mesh.size_m.prod(),
               area = spec.mesh.size_m.x() * spec.mesh.size_m.y();
  double bounded = 1.0 + 2.0 * stiffness * area * kThrowPeriod * kThrowPeriod / mass;
  const bool multi_rate = is_multirate(column);
  if (column.fixed && (multi_rate || is_explicit(column))) {
    scene::Description alone = d;
    alone.integrator.name = "linearly-implicit-euler";
    const auto world = loop::assemble(alone);
    if (multi_rate)
      bounded += 2.0 * std::pow(largest_frequency(world->system, world->state.view()) * kThrowPeriod, 2);
    else
      bounded = std::max(
          bounded, explicit_gain(column, std::sqrt(largest_contact_rate2(world->bodies[0], stiffness))));
  }
  double stable = 100.0 * kThrowRtol;
  if (!column.fixed)
    stable *= std::max(1.0, IntegratorSpec{}.atol_u * std::sqrt(spec.youngs_modulus_pa / spec.density_kg_m3) /
                                spec.velocity_m_s.norm());
  return {stable, std::max(stable, bounded)};
}

}  // namespace palpate::stability
