#include <cmath>

#include "bouncing_punch.h"
#include "cases.h"
#include "palpate/core/error.h"
#include "palpate/core/named_enum.h"

// Problem: a flat punch with area A and mass m meets a plane at speed v0, without gravity. The contact is one
// spring K = k A with a damper c = d A:
//     m x'' + c x' + K x = 0,   x(0) = 0, x'(0) = v0 (depth),   w = sqrt(K/m), zeta = c/(2 sqrt(K m)).
//
// Exact answer:
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
//
// Measured: duration of contact, restitution and depth at the release, by cvode-bdf with rtol 1e-8. Limit
// 1e-6 where the motion is smooth but for kinks, 1e-5 with damping. The integrator is not restarted at the
// kink at touch, the jump of a damper at touch, or the kink at the end of the force: it runs from free flight
// to free flight. Touch and release are evaluated from its dense output, step by step. Each quantity is
// measured with both ways in which the library handles these points: error control alone, and location of the
// kinks as roots. Fixed-step methods must show their order in contact (+/- 0.1), and order 1 through a damped
// touch, where the force jumps within a step.

namespace palpate::validation {
namespace {

using namespace punch;

IntegratorSpec cvode(KinkTreatment events) {
  IntegratorSpec spec;
  spec.name = "cvode-bdf";
  spec.rtol = 1e-8;
  spec.events = events;
  return spec;
}

IntegratorSpec fixed_step(const std::string& name, double step) {
  IntegratorSpec spec;
  spec.name = name;
  spec.fixed_step = true;
  spec.step_s = step;
  spec.rtol = spec.newton_rtol = 1e-11;
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
  double duration;     ///< From touch to the end of the force [s].
  double restitution;  ///< Speed after over speed before.
  double depth_left;   ///< Depth when the force ended [m].
};

Outcome bounce(const Bounce::Law& law, KinkTreatment events, const std::string& fault) {
  Bounce b(kHeight, law, cvode(events), fault);
  const Contact contact(b);
  b.advance(kHeight / kSpeed + 2.0 * kPi / kOmega);  // Well after separation.
  return {contact.release - contact.touch, b.velocity() / kSpeed, contact.depth_left};
}

constexpr KinkTreatment kWays[] = {KinkTreatment::kErrorControl, KinkTreatment::kRootFinding};

struct Method {
  const char* name;
  int order;
};
constexpr Method kMethods[] = {{"linearly-implicit-euler", 1},
                               {"backward-euler", 1},
                               {"symplectic-euler", 1},
                               {"implicit-midpoint", 2},
                               {"bdf2", 2},
                               {"linearly-implicit-bdf2", 2},
                               {"newmark", 2},
                               {"generalized-alpha", 2},
                               {"ark-dirk-esdirk324", 3},
                               {"rk4", 4}};

/// Measures the order of a fixed-step method in smooth contact: depth and speed after a quarter period
/// against the harmonic motion.
Measurement order_in_contact(const Method& method, const std::string& fault) {
  std::vector<double> h, error;
  const double end = 0.5 * kPi / kOmega;
  for (const int part : {1, 2, 4, 8}) {
    const int steps = (method.order > 2 ? 10 : 100) * part;
    Bounce b(0.0, {}, fixed_step(method.name, end / steps), fault);
    b.state.q()[2] = -1e-12;  // In contact from the start.
    b.advance(end);
    h.push_back(end / steps);
    // Exact: x = v0/w, x' = 0.
    error.push_back(std::hypot(kOmega * b.height() + kSpeed, b.velocity()) / kSpeed);
  }
  Measurement m = against(fmt::format("{} in contact, {} steps per quarter period: depth w/v0 and speed/v0",
                                      method.name, method.order > 2 ? 80 : 800),
                          1.0 + error.back(), 1.0, 5e-3);
  m.order = validation::fitted_order(h, error);
  m.order_low = method.order - 0.1;
  m.order_high = method.order + 0.1;
  m.refinement = {"step [s]", h, error};
  return m;
}

/// Measures free flight, where x' is constant: every consistent method is exact, for any step.
Measurement free_flight(const Method& method, const std::string& fault) {
  Bounce b(1.0, {}, fixed_step(method.name, 1e-3), fault);
  b.advance(0.1);
  return against(fmt::format("{} in free flight, height after 100 steps [m]", method.name), b.height(),
                 1.0 - 0.1 * kSpeed, 1e-12);
}

/// Measures the order of a fixed-step method through a damped bounce: the force jumps at touch, within a
/// step, so every method has order 1. The position of the jump within the step varies: RMS over starting
/// heights.
Measurement order_through_touch(double zeta, double e, const std::string& fault) {
  constexpr int kHeights = 32;
  std::vector<double> h, error;
  double last = 0.0;
  for (const int steps : {200, 400, 800, 1600}) {
    const double step = kPi / kOmega / steps;
    double squares = 0.0;
    for (int i = 0; i < kHeights; ++i) {
      Bounce b(step * kSpeed * (10.0 + (i + 0.5) / kHeights), {.zeta = zeta},
               fixed_step("linearly-implicit-euler", step), fault);
      b.advance(step * (steps + 20));  // Touches after 10 to 11 steps, and has separated by the end.
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
  std::vector<Measurement> out;
  for (const KinkTreatment way : kWays) {
    const Outcome o = bounce({}, way, fault);
    const std::string name = fmt::format("cvode-bdf, rtol 1e-8, {}: ", name_of(way));
    out.push_back(against(name + "contact duration [s]", o.duration, kPi / kOmega, 1e-6));
    out.push_back(against(name + "speed after over speed before", o.restitution, 1.0, 1e-6));
    out.push_back(
        against(name + "energy after over energy before", o.restitution * o.restitution, 1.0, 1e-6));
  }
  for (const Method& method : kMethods) out.push_back(order_in_contact(method, fault));
  for (const Method& method : kMethods) out.push_back(free_flight(method, fault));
  return out;
}

std::vector<Measurement> run_damped(const std::string& fault) {
  std::vector<Measurement> out;
  for (const double zeta : {0.1, 0.3, 0.5, 1.0}) {
    const double s = std::sqrt(1.0 - zeta * zeta);
    const double angle = kPi - std::atan2(2.0 * zeta * s, 1.0 - 2.0 * zeta * zeta);
    const double e = zeta < 1.0 ? std::exp(-zeta / s * angle) : std::exp(-2.0);
    const double duration = zeta < 1.0 ? angle / (kOmega * s) : 2.0 / kOmega;
    for (const KinkTreatment way : kWays) {
      const Outcome o = bounce({.zeta = zeta}, way, fault);
      const std::string name = fmt::format("{}, zeta = {}: ", name_of(way), zeta);
      out.push_back(against(name + "coefficient of restitution", o.restitution, e, 1e-5));
      out.push_back(against(name + "contact duration [s]", o.duration, duration, 1e-5));
      Measurement left;
      left.quantity = name + "depth left when the force ends [m] (must be > 0)";
      left.computed = o.depth_left;
      left.exact = zeta < 1.0 ? kSpeed / (kOmega * s) * std::exp(-zeta / s * angle) * std::sin(angle)
                              : kSpeed / kOmega * 2.0 * std::exp(-2.0);
      left.error = o.depth_left > 0.0 ? std::abs(left.computed / left.exact - 1.0) : 1.0;
      left.bar = 1e-5;
      out.push_back(left);
    }
    if (zeta == 0.3) out.push_back(order_through_touch(zeta, e, fault));
  }
  return out;
}

/// Returns the root e in (0, 1) of G(u) = G(-e u) by bisection: G(-e u) grows with e from 0.
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
  for (const bool stepped : {false, true})
    for (const double u : {0.3, 1.0})  // a v0 = 3/2 c v0
      for (const KinkTreatment way : kWays) {
        const Bounce::Law law{.zeta = u / 3.0, .hunt_crossley = true, .stepped = stepped};
        out.push_back(against(fmt::format("{} punch, {}, 3/2 c v0 = {}: coefficient of restitution",
                                          stepped ? "stepped" : "flat", name_of(way), u),
                              bounce(law, way, fault).restitution, hunt_crossley_restitution(u), 1e-5));
      }
  return out;
}

}  // namespace

ValidationCase punch_bounce() {
  return {"punch-bounce",
          "B",
          "Undamped bounce of a flat punch on a plane: duration, speed, energy; fixed-step order in contact",
          "A flat contact is one linear spring k A: it must return the energy that it stores, with any "
          "integrator.",
          false,
          true,
          run_undamped,
          {{"half-area", "contact duration"},
           {"tolerance-ignored", "contact duration"},
           {"first-order-rule", "implicit-midpoint in contact"},
           {"drag", "in free flight"}}};
}

ValidationCase punch_bounce_damped() {
  return {
      "punch-bounce-damped",
      "B",
      "Bounce of a flat punch with Kelvin-Voigt damping and no adhesion, zeta = 0.1, 0.3, 0.5, 1",
      "The pressure is cut off at zero, so the punch separates before the depth vanishes: the closed form "
      "includes the cut-off.",
      false,
      true,
      run_damped,
      {{"half-damping", "coefficient of restitution"},
       {"other-law", "contact duration"},
       {"adhesive", "coefficient of restitution"}}};
}

ValidationCase punch_bounce_hunt_crossley() {
  return {
      "punch-bounce-hunt-crossley",
      "B",
      "Bounce with Hunt-Crossley damping against its implicit closed form, 3/2 c v0 = 0.3 and 1, two shapes",
      "The continuous damping law: its loss depends on speed, unlike that of a linear damper.",
      false,
      true,
      run_hunt_crossley,
      {{"other-law", "coefficient of restitution"}, {"half-damping", "coefficient of restitution"}}};
}

}  // namespace palpate::validation
