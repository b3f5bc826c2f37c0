#include <cmath>
#include <functional>

#include "b_bodies.h"
#include "cases.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/system.h"
#include "palpate/integrate/integrators.h"

// A flat punch of area A and mass m meets a plane at speed v0, without gravity.  The contact is one spring K
// = k A with damper c = d A:
//     m x'' + c x' + K x = 0,   x(0) = 0, x'(0) = v0 (depth),   w = sqrt(K/m), zeta = c/(2 sqrt(K m)).
// - No damping: x = v0/w sin(w t); contact lasts pi/w, and the speed is restored fully.
// - Kelvin-Voigt without adhesion, zeta < 1, s = sqrt(1 - zeta^2), b = zeta/s:
//       x = v0/(w s) exp(-zeta w t) sin(w s t).
//   The contact force K x + c x' is zero when tan(w s t) = -2 zeta s/(1 - 2 zeta^2), first at
//       w s t1 = pi - atan2(2 zeta s, 1 - 2 zeta^2),
//   with depth still > 0; from there it would pull, so the punch separates with x'(t1):
//       e = -x'(t1)/v0 = exp(-b (pi - atan2(2 zeta s, 1 - 2 zeta^2))).
//   zeta = 1 is the limit: w t1 = 2, e = exp(-2).  zeta = 0.1, 0.3, 0.5 give e = 0.744079, 0.450975,
//   0.298436.
// - Hunt-Crossley (1975), a = 3 c/2: the equation m v v'(x) = -K x (1 + a v) separates into
//       m v dv/(1 + a v) = -K x dx,
//   and x vanishes at both ends, so the integral of v/(1 + a v) from -e v0 to v0 is zero:
//       G(a v0) = G(-e a v0),   G(u) = u - ln(1 + u).
//   It holds for any shape, as only p(x) (1 + a v) was used.

namespace palpate::validation {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kMass = 0.2, kArea = 1e-4, kStiffness = 2e7;  // K = 2000 N/m, w = 100 rad/s
constexpr double kSpeed = 0.5, kHeight = 2e-3;
const double kOmega = std::sqrt(kStiffness * kArea / kMass);

/// The punch above (or in) the plane, through the real contact term, system and stepper.
struct Bounce {
  dynamics::State state;
  dynamics::System system;
  std::shared_ptr<contact::ContactForce> term = std::make_shared<contact::ContactForce>();
  std::unique_ptr<dynamics::Stepper> stepper;

  Bounce(double height, double zeta, const IntegratorSpec& integrator, const std::string& fault) {
    dynamics::BlockSpec node;
    node.name = "punch";
    node.q_size = node.u_size = 3;
    node.q_scale = kSpeed / kOmega;
    node.u_scale = kSpeed;
    const int id = state.insert(node, Vec3(0.1, -0.2, height), Vec3(0, 0, -kSpeed));
    term->add_frame(contact::fixed_frame());
    ContactSpec law;
    law.stiffness_pa_m = kStiffness;
    law.damping_pa_s_m =
        2.0 * zeta * std::sqrt(kStiffness * kArea * kMass) / kArea * (fault == "half-damping" ? 0.5 : 1.0);
    if (fault == "hunt-crossley") {
      law.law = "hunt_crossley";
      law.hunt_crossley_s_m = 2.0 * zeta / kSpeed;  // a v0 = 3 zeta
    }
    term->add_pair(make_punch_source(0, fault == "half-area" ? 0.5 * kArea : kArea, 4, 0), law);
    system.add(term);
    system.add(std::make_shared<PointMass>(id, kMass));
    term->refresh(state.view());
    system.prepare(state.view());
    stepper = integrate::make_stepper(system, state, integrator);
  }

  double height() const { return state.q()[2]; }
  double velocity() const { return state.u()[2]; }
  double force_at(double t, const VecX& q, const VecX& u) {
    VecX f = VecX::Zero(3);
    term->add_force(state.view(t, q.data(), u.data()), f);
    return f[2];
  }

  dynamics::StepResult advance(double t) {
    const auto result = stepper->advance_to(t);
    if (!result.ok()) fail("punch bounce: {}", result.message);
    return result;
  }

  void restart(double t, const VecX& q, const VecX& u) {
    state.q() = q;
    state.u() = u;
    state.set_time(t);
    stepper->reinit(dynamics::ReinitReason::kStateChanged);
  }

  using Root = std::function<double(const VecX& q, const VecX& u)>;
  /// Advances by short outputs until the root function is no longer positive, finds where by bisection on the
  /// dense output of that step, and restarts there: no step of the method straddles the kink.  Returns that
  /// time.
  double advance_to_root(double dt, const Root& root) {
    VecX q(3), u(3);
    while (state.time() < 1.0) {
      const double t0 = state.time();
      const VecX q0 = state.q(), u0 = state.u();
      const double t1 = t0 + dt;
      const double h = advance(t1).h;
      if (root(state.q(), state.u()) > 0.0) continue;
      double low = std::max(t0, t1 - h), high = t1;
      // crossed in an earlier step, which the dense output no longer covers
      if (!stepper->dense_output(low, q, u) || root(q, u) <= 0.0) {
        restart(t0, q0, u0);
        dt /= 8.0;
        continue;
      }
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        PALPATE_CHECK(stepper->dense_output(middle, q, u), "no dense output at t = {}", middle);
        (root(q, u) > 0.0 ? low : high) = middle;
      }
      stepper->dense_output(high, q, u);
      restart(high, q, u);
      return high;
    }
    return std::nan("");
  }
};

IntegratorSpec cvode(double rtol) {
  IntegratorSpec spec;
  spec.name = "cvode-bdf";
  spec.rtol = rtol;
  return spec;
}

IntegratorSpec fixed_step(double step) {
  IntegratorSpec spec;
  spec.name = "linearly-implicit-euler";
  spec.step_s = step;
  return spec;
}

Measurement against(const std::string& quantity, double computed, double exact, double bar) {
  Measurement m;
  m.quantity = quantity;
  m.computed = computed;
  m.exact = exact;
  m.error = std::abs(computed - exact) / std::abs(exact);
  m.bar = bar;
  return m;
}

struct Outcome {
  double duration;     ///< from touch to the end of the force [s]
  double restitution;  ///< speed after over speed before
  double depth_left;   ///< when the force ended [m]
};

Outcome bounce(double zeta, double rtol, const std::string& fault) {
  Bounce b(kHeight, zeta, cvode(rtol), fault);
  const double dt = 0.02 / kOmega;
  const double touch = b.advance_to_root(dt, [](const VecX& q, const VecX&) { return q[2]; });
  b.advance(touch + dt);  // into the contact
  const double release =
      b.advance_to_root(dt, [&](const VecX& q, const VecX& u) { return b.force_at(0.0, q, u); });
  const double depth = -b.height();
  b.advance(release + kPi / kOmega);  // away
  return {release - touch, b.velocity() / kSpeed, depth};
}

/// Order of a fixed-step method in smooth contact: depth and speed after a quarter period against the
/// harmonic motion.
Measurement order_in_contact(const std::string& fault) {
  std::vector<double> h, error;
  const double end = 0.5 * kPi / kOmega;
  for (const int steps : {100, 200, 400, 800}) {
    Bounce b(0.0, 0.0, fixed_step(end / steps), fault);
    b.state.q()[2] = -1e-12;  // in contact from the start
    b.advance(end);
    h.push_back(end / steps);
    // exact: x = v0/w, x' = 0
    error.push_back(std::hypot(kOmega * b.height() + kSpeed, b.velocity()) / kSpeed);
  }
  Measurement m =
      against("linearly-implicit-euler in contact, 800 steps a quarter period: depth w/v0 and speed/v0",
              1.0 + error.back(), 1.0, 5e-3);
  m.order = validation::fitted_order(h, error);
  m.order_low = 0.9;
  m.order_high = 1.1;
  return m;
}

/// In free flight x' is constant: every consistent method is exact, whatever its step.
Measurement free_flight(const std::string& fault) {
  Bounce b(1.0, 0.0, fixed_step(1e-3), fault);
  b.advance(0.1);
  return against("linearly-implicit-euler in free flight, height after 100 steps [m]", b.height(),
                 1.0 - 0.1 * kSpeed, 1e-12);
}

/// Order of a fixed-step method through a damped bounce: the force jumps at touch, somewhere inside a step,
/// so order 1 whatever the method.  The position of the jump within the step is random: RMS over starting
/// heights.
Measurement order_through_touch(double zeta, double e, const std::string& fault) {
  constexpr int kHeights = 32;
  std::vector<double> h, error;
  double last = 0.0;
  for (const int steps : {200, 400, 800, 1600}) {
    const double step = kPi / kOmega / steps;
    double squares = 0.0;
    for (int i = 0; i < kHeights; ++i) {
      Bounce b(step * kSpeed * (10.0 + (i + 0.5) / kHeights), zeta, fixed_step(step), fault);
      b.advance(step * (steps + 20));  // touches after 10 to 11 steps, and has left by then
      last = b.velocity() / kSpeed;
      squares += std::pow(last / e - 1.0, 2) / kHeights;
    }
    h.push_back(step);
    error.push_back(std::sqrt(squares));
  }
  Measurement m = against(
      fmt::format(
          "restitution by linearly-implicit-euler through touch and release, zeta = {}, RMS over 32 heights",
          zeta),
      last, e, 1e-2);
  m.error = error.back();
  m.order = validation::fitted_order(h, error);
  m.order_low = 0.9;
  m.order_high = 1.1;
  return m;
}

std::vector<Measurement> run_undamped(const std::string& fault) {
  const Outcome o = bounce(0.0, fault == "loose-tolerance" ? 1e-3 : 1e-8, fault);
  return {against("contact duration, cvode-bdf, rtol 1e-8 [s]", o.duration, kPi / kOmega, 1e-6),
          against("speed after over speed before", o.restitution, 1.0, 1e-6),
          against("energy after over energy before", o.restitution * o.restitution, 1.0, 1e-6),
          order_in_contact(fault), free_flight(fault)};
}

std::vector<Measurement> run_damped(const std::string& fault) {
  std::vector<Measurement> out;
  for (const double zeta : {0.1, 0.3, 0.5, 1.0}) {
    const double s = std::sqrt(1.0 - zeta * zeta);
    const double angle = kPi - std::atan2(2.0 * zeta * s, 1.0 - 2.0 * zeta * zeta);
    const double e = zeta < 1.0 ? std::exp(-zeta / s * angle) : std::exp(-2.0);
    const double duration = zeta < 1.0 ? angle / (kOmega * s) : 2.0 / kOmega;
    const Outcome o = bounce(zeta, 1e-8, fault);
    out.push_back(
        against(fmt::format("coefficient of restitution, zeta = {}", zeta), o.restitution, e, 1e-5));
    out.push_back(against(fmt::format("contact duration, zeta = {} [s]", zeta), o.duration, duration, 1e-5));
    Measurement left;
    left.quantity =
        fmt::format("depth left when the force ends, zeta = {} [m] (absolute: must be > 0)", zeta);
    left.computed = o.depth_left;
    left.exact = zeta < 1.0 ? kSpeed / (kOmega * s) * std::exp(-zeta / s * angle) * std::sin(angle)
                            : kSpeed / kOmega * 2.0 * std::exp(-2.0);
    left.error = o.depth_left > 0.0 ? std::abs(left.computed / left.exact - 1.0) : 1.0;
    left.bar = 1e-5;
    out.push_back(left);
    if (zeta == 0.3) out.push_back(order_through_touch(zeta, e, fault));
  }
  return out;
}

/// The root e in (0, 1) of G(u) = G(-e u), by bisection: G(-e u) grows with e from 0.
double hunt_crossley_restitution(double u) {
  const auto G = [](double x) { return x - std::log1p(x); };
  double low = 0.0, high = std::min(1.0, 1.0 / u);
  for (int i = 0; i < 200; ++i) {
    const double e = 0.5 * (low + high);
    (e * u < 1.0 && G(-e * u) < G(u) ? low : high) = e;
  }
  return low;
}

std::vector<Measurement> run_hunt_crossley(const std::string& fault) {
  std::vector<Measurement> out;
  for (const double u : {0.3, 1.0}) {  // a v0 = 3/2 c v0
    const Outcome o = bounce(u / 3.0, 1e-8, fault.empty() ? "hunt-crossley" : fault);
    out.push_back(against(fmt::format("coefficient of restitution, 3/2 c v0 = {}", u), o.restitution,
                          hunt_crossley_restitution(u), 1e-5));
  }
  return out;
}

}  // namespace

ValidationCase punch_bounce() {
  return {"punch-bounce",
          "B",
          "Undamped bounce of a flat punch on a plane: duration, speed, energy; fixed-step order in contact",
          "A flat contact is one linear spring k A: it must give back what it took, through any integrator.",
          false,
          run_undamped,
          {"half-area", "loose-tolerance"}};
}

ValidationCase punch_bounce_damped() {
  return {
      "punch-bounce-damped",
      "B",
      "Bounce of a flat punch with Kelvin-Voigt damping and no adhesion, zeta = 0.1, 0.3, 0.5, 1",
      "The pressure is cut where it would pull, so the punch separates before the depth is gone: the closed "
      "form of exactly that.",
      false,
      run_damped,
      {"half-damping", "hunt-crossley"}};
}

ValidationCase punch_bounce_hunt_crossley() {
  return {"punch-bounce-hunt-crossley",
          "B",
          "Bounce with Hunt-Crossley damping against its implicit closed form, 3/2 c v0 = 0.3 and 1",
          "The continuous damping law: its loss depends on speed in a way that no linear damper copies.",
          false,
          run_hunt_crossley,
          {"kelvin-voigt"}};
}

}  // namespace palpate::validation
