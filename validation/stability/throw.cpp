#include "throw.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "frequency.h"
#include "modal_steps.h"
#include "multirate_theory.h"

// A body thrown at an obstacle. Without gravity the available energy is that of the throw, E0 = 1/2 m v^2;
// the mechanical energy includes body and contact spring. In continuous time it never rises: damping
// dissipates, the gap of a face with a fixed normal is conservative, and a vertex found nearer to another
// face, or no longer inside, reduces the energy of its spring.
// - Error control satisfies this within its tolerance, summed over the steps.  A step may have the error rtol
//   (atol_u c + rms u) in speed, c = sqrt(E/rho) the scale of speeds (error_weights.h): for a body at speed v
//   a relative rtol max(1, atol_u c/v), and in energy at most twice that; with some hundred relevant steps
//   1e-2 E0, and more for a body slower than a tenth of its wave speed.
//     -> stable; error
// - A fixed step H has no such theorem.  Where the tangent is evaluated at the step's start, the contact is
//   open there: the body moves on by v H into the plane, and the spring then stores
//       1/2 k A (v H)^2 = (k A H^2/m) E0 = (8e-8 k m/Pa) E0,
//   so at k = 1e12 Pa/m far more than was available, to be returned as velocity or damped, depending on the
//   method.  Twice this and E0 once more (a second touch, a bending body) is the bound; nothing explains
//   more. Methods that solve for the contact at the step's end do not need it.
//     -> stable, bounded; error
// - A multi-rate step has this flaw on its other side: within it the contact moves nodes while the elastic
//   force is a given polynomial of time. Nodes that move on by v H without an elastic reaction load the
//   springs between them by up to (w H)^2 E0, w the body's largest frequency. Twice this is added to the
//   bound; but where the step's matrix with all of the lower side in contact has a spectral radius r above 1
//   (multirate_theory.cpp), each of the n steps of a touch multiplies the energy: where r^(2 n) > 2, n the
//   steps of the row, there is no bound.
//     -> stable, bounded, grew; error
//   Generalised-alpha keeps the acceleration from the step that closed the contact: the bound is multiplied
//   by the square of the effect of its first step on a rigid body on the contact, by its formula
//   (modal_steps.h).
// - Explicit fixed steps.  Where the body's fastest mode is outside the method's limit by its formula, it
//   overflows, and must report this.
//     -> error
//   A node on the contact alone is an oscillator with w_c^2 = k A_n/m_n.  Within the limit for it, the energy
//   is bounded by the square of the growth in a touch of n = 1 + ceil(pi/y) steps or fewer, y = w_c H: the
//   largest norm of a power, where this is more than the bound above.
//     -> stable, bounded
//   Outside it there is no bound: the body may be thrown back at any speed by a step or two, and is then free
//   (its flight before that is as everywhere).
//     -> bounded, grew, error; where one step can multiply the energy by less than 1e6, also stable
// - Statics has no velocity: a free body is in equilibrium in its initial position and remains there.
//     -> stable
//
// Required for every method (otherwise: wrong):
// - Flight.  The throw is 2.5 periods high.  Without a force every consistent method, at any step, moves the
//   centre of mass by -v t: after each of two periods it is there, to 1e-6 of v t (rtol under error control).
// - Reversal.  The obstacle's force is upwards.  Where a rigid body on the contact alone would reverse by the
//   end, w (T - t0) > pi/2 with w^2 = k A/m and t0 the time of touching, the speed of the centre of mass is
//   then not downwards (to 5 % of v); otherwise it is that of the rigid body, -v cos(w (T - t0)), to 5 % of
//   v: the body, k L/E times softer than the contact, changes it by k L/E, which is below 1 % there.  A body
//   counted as having gone through the obstacle need not reverse.
// - An early end has a reason: at explicit fixed steps an energy beyond 1e3 of the initial one, under error
//   control the limit of steps reached.  At an implicit fixed step, Newton's method may fail where the body
//   moves by more than kTooFar of its thicknesses in a period, so that the first step in contact inverts its
//   elements: there an error is accepted, after a correct flight.
//     -> error as well

namespace palpate::stability {
namespace {

constexpr double kPeriodsOfFlight = 2.5, kFlightError = 1e-6, kTurnError = 0.05;
constexpr double kThrownBack = 1e6;  // Energy factor of one step: it then cannot appear stable.
constexpr double kTooFar = 10.0;     // Thicknesses per period: between the rows' 4, and 40 at 100 m/s.

/// Returns the mass of the thrown body; with a second body, the reduced mass of both [kg].
double reduced_mass(const scene::Description& d) {
  double inverse = 0.0;
  for (const SoftBodySpec& body : d.bodies) inverse += 1.0 / (body.density_kg_m3 * body.mesh.size_m.prod());
  return 1.0 / inverse;
}

/// Returns w of a rigid body on the contact alone [rad/s].
double rigid_rate(const scene::Description& d) {
  const Vec3& size = d.bodies[0].mesh.size_m;
  return std::sqrt(d.contacts[0].stiffness_pa_m * size.x() * size.y() / reduced_mass(d));
}

/// Records the course of the centre of mass.
class Flight {
 public:
  explicit Flight(const scene::Description& d)
      : speed_(d.bodies[0].velocity_m_s.norm()), rate_(rigid_rate(d)) {}
  void probe(const loop::World& world, double t) {
    const loop::Body& body = world.bodies[0];
    const dynamics::Block* block = world.state.layout().find(body.block_id);
    const Eigen::Map<const Points> v(world.state.u().data() + block->u_offset, 3, block->u_size / 3);
    const double mass = body.masses.sum();
    if (t <= kThrowDuration * (1.0 + 1e-9)) last_speed_ = (v * body.masses)[2] / mass;
    if (!(t > 0.0) || t > 2.01 * kThrowPeriod) return;
    const Vec3 moved = (world.positions(body) - body.placed) * body.masses / mass;
    off_ = std::max(off_, (moved + Vec3(0, 0, speed_ * t)).norm() / (speed_ * t));
    ++flown_;
  }
  /// Returns the discrepancy from free flight; empty if there is none.
  std::string in_flight(const Column& column) const {
    if (flown_ < 2) return "the run ended in free flight";
    if (!(off_ <= (column.fixed ? kFlightError : kThrowRtol)))
      return fmt::format("in free flight its error is {:.1e} of the distance", off_);
    return {};
  }
  std::string mistake(const Column& column, bool passed) const {
    if (is_static(column)) return {};
    if (std::string early = in_flight(column); !early.empty() || passed) return early;
    const double phase = rate_ * (kThrowDuration - kPeriodsOfFlight * kThrowPeriod);
    if (phase > 0.5 * M_PI)
      return last_speed_ >= -kTurnError * speed_
                 ? std::string()
                 : fmt::format("not reversed: its speed is {:.2f} of the initial speed",
                               -last_speed_ / speed_);
    const double rigid = -std::cos(phase);
    return std::abs(last_speed_ / speed_ - rigid) <= kTurnError
               ? std::string()
               : fmt::format("its speed is {:.3f} of the initial speed, that of a rigid body {:.3f}",
                             last_speed_ / speed_, rigid);
  }
  double last_speed() const { return last_speed_ / speed_; }

 private:
  double speed_, rate_, off_ = 0.0, last_speed_ = 0.0;
  int flown_ = 0;
};

/// Returns the largest k A_n/m_n of the body's lower side [rad^2/s^2], A_n a third of the faces around the
/// node.
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

/// Theoretical bounds for an explicit method at fixed steps on a throw.
struct ExplicitTheory {
  bool body_is_stable, contact_is_stable;
  double gain;      ///< Relative energy gain in a touch, if contact is stable.
  double one_step;  ///< Factor of the energy in one step in contact.
};

ExplicitTheory explicit_theory(const Column& column, const scene::Description& d) {
  scene::Description alone = d;
  alone.integrator.name = "linearly-implicit-euler";
  const auto world = loop::assemble(alone);
  const double w = largest_frequency(world->system, world->state.view()),
               y = kThrowPeriod *
                   std::sqrt(largest_contact_rate2(world->bodies[0], d.contacts[0].stiffness_pa_m));
  const ModalSteps body(column, w * kThrowPeriod, 0.5 * d.bodies[0].stiffness_damping_s * w),
      contact(column, y, 0.0);
  constexpr double kRounds = 1e-9;
  MatX touch = MatX::Identity(2, 2);
  double most = 1.0;  // A touch may end after any of its steps.
  const bool stable = contact.spectral_radius() <= 1.0 + kRounds;
  for (int i = 0; stable && i < 1 + static_cast<int>(std::ceil(M_PI / y)); ++i) {
    touch = contact.next() * touch;
    most = std::max(most, touch.operatorNorm());
  }
  return {body.spectral_radius() <= 1.0 + kRounds, stable, most * most - 1.0,
          std::pow(contact.norm_of_first(), 2)};
}

/// Returns the factor by which the energy may grow with a multi-rate method while the whole lower side is in
/// contact.
double growth_in_contact(const Column& column, scene::Description d) {
  constexpr double kDepth = 1e-6;
  d.integrator.name = "linearly-implicit-euler";
  const auto world = loop::assemble(d);
  VecX q = world->state.q();
  const dynamics::Block* thrown = world->state.layout().find(world->bodies[0].block_id);
  for (int i = thrown->q_offset + 2; i < thrown->q_offset + thrown->q_size; i += 3)
    q[i] -= kPeriodsOfFlight * kThrowPeriod * d.bodies[0].velocity_m_s.norm() + kDepth;
  const double r = multirate_amplification_at(column, *world, q, world->state.u(), kThrowPeriod);
  return std::pow(r, 2.0 * kThrowDuration / kThrowPeriod);
}

}  // namespace

scene::Description thrown_at(scene::Description d, const ObstacleSpec& obstacle, double speed,
                             double stiffness_pa_m) {
  d.duration_s = kThrowDuration;
  d.bodies[0].position_m.z() += kPeriodsOfFlight * speed * kThrowPeriod;
  d.bodies[0].velocity_m_s = Vec3(0, 0, -speed);
  d.obstacles.push_back(obstacle);
  ContactSpec contact;
  contact.first = d.bodies[0].name;
  contact.second = obstacle.name;
  contact.method = "analytic";  // k times the area of a side at any depth, as in theory.
  contact.stiffness_pa_m = stiffness_pa_m;
  d.contacts.push_back(contact);
  d.exchange.contact_refresh_s = kThrowPeriod;
  return d;
}

Verdicts expect_thrown(const CaseContext& context, const scene::Description& d) {
  if (is_static(context.column)) return {Verdict::kStable};
  if (is_multirate(context.column) && growth_in_contact(context.column, d) > 2.0)
    return {Verdict::kStable, Verdict::kBounded, Verdict::kGrew, Verdict::kError};
  if (!context.column.fixed) return {Verdict::kStable};
  if (is_explicit(context.column)) {
    const ExplicitTheory theory = explicit_theory(context.column, d);
    if (!theory.body_is_stable) return {Verdict::kError};
    if (theory.contact_is_stable) return {Verdict::kStable, Verdict::kBounded};
    if (theory.one_step > kThrownBack) return {Verdict::kBounded, Verdict::kGrew, Verdict::kError};
    return {Verdict::kStable, Verdict::kBounded, Verdict::kGrew, Verdict::kError};
  }
  const SoftBodySpec& body = d.bodies[0];
  if (body.velocity_m_s.norm() * kThrowPeriod > kTooFar * body.mesh.size_m.minCoeff())
    return {Verdict::kStable, Verdict::kBounded, Verdict::kError};
  return {Verdict::kStable, Verdict::kBounded};
}

GainBars throw_bars(const Column& column, const scene::Description& d) {
  const SoftBodySpec& spec = d.bodies[0];
  const double stiffness = d.contacts[0].stiffness_pa_m;
  const double mass = reduced_mass(d), area = spec.mesh.size_m.x() * spec.mesh.size_m.y();
  double bounded = 1.0 + 2.0 * stiffness * area * kThrowPeriod * kThrowPeriod / mass;
  if (is_multirate(column)) {
    scene::Description alone = d;
    alone.integrator.name = "linearly-implicit-euler";
    const auto world = loop::assemble(alone);
    bounded += 2.0 * std::pow(largest_frequency(world->system, world->state.view()) * kThrowPeriod, 2);
  } else if (column.fixed && is_explicit(column)) {
    const ExplicitTheory theory = explicit_theory(column, d);
    if (theory.contact_is_stable) bounded = std::max(bounded, theory.gain);
  } else if (column.name == "generalized-alpha") {
    bounded *= std::pow(ModalSteps(column, rigid_rate(d) * kThrowPeriod, 0.0).norm_of_first(), 2);
  }
  double stable = 100.0 * kThrowRtol;
  if (!column.fixed)
    stable *= std::max(1.0, IntegratorSpec{}.atol_u * std::sqrt(spec.youngs_modulus_pa / spec.density_kg_m3) /
                                spec.velocity_m_s.norm());
  return {stable, std::max(stable, bounded)};
}

StabilityCell projectile_case(const CaseContext& context, const scene::Description& d, const Probe& probe,
                              const std::function<bool()>& passes) {
  Flight flight(d);
  const SceneCourse course = run_scene(context, d, kThrowRtol, 0.0, [&](loop::World& world, double t) {
    flight.probe(world, t);
    if (probe) probe(world, t);
  });
  StabilityCell cell;
  judge(context, course, throw_bars(context.column, d), cell);
  cell.figure += fmt::format(", leaves at {:+.2f} of its speed", flight.last_speed());
  std::string mistake;
  if (cell.verdict == Verdict::kError) {
    const bool by_newton = context.column.fixed && !is_explicit(context.column);
    mistake = by_newton ? flight.in_flight(context.column) : gave_up_early(context, course);
  } else if (cell.verdict <= Verdict::kBounded) {
    mistake = flight.mistake(context.column, passes && passes());
  } else if (cell.verdict == Verdict::kGrew) {
    mistake = flight.in_flight(context.column);
  }
  mark_wrong(mistake, cell);
  return cell;
}

}  // namespace palpate::stability
